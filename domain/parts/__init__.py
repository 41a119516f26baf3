"""The parts of the robot: their model, what is known of them, what follows, and what is wanted.

Read `system_model.py` first, then `mode_inference.py`.
"""
