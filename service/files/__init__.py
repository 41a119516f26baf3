"""Files that a person writes: models and robot files, with line and column of what is wrong.

Read `model_file.py` first; below it the layers go down to YAML.
"""
