"""Everything that decides, and the simulated robot: deterministic, without I/O, time handed in.

Read `supervision.py` first (one input, what it leads to), then `mode_inference.py`, `changes.py`
and `state_manager.py`. The words are those of micro-ROS system_modes and smart_polaris.
"""
