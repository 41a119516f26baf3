"""Files written by people: models, robot files and waypoints; findings have line and column.

Read `model_file.py` first; below it the layers go down to YAML.
"""
