"""Everything that decides, and the simulated robot: deterministic, without I/O, time handed in.

Read `supervision.py` first (one input, what it leads to), then `mode_inference.py` and the packages
`changes/` (what a request means, and its steps) and `health/` (signals and errors). The words are
those of micro-ROS system_modes and smart_polaris; the types of all of them are in `lifecycle.py`,
`system_model.py`, `messages.py` (what goes in and out) and `snapshot.py` (what can be seen).
"""
