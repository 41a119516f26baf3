"""The parts of the robot: their model, facts, inferred states and targets.

Read `system_model.py` first, then `mode_inference.py`.
"""
