"""Everything that decides, and the simulated robot: deterministic, without I/O, time handed in.

Read `supervision.py` first (one input, what it leads to), then `mode_inference.py` and the packages
`changes/` (what a request means, and its steps), `health/` (signals and errors) and `tasks/` (what
is driven, and what holds it). `navigation.py` follows a path with what is in `paths/` and
`tracking/`; `onboard.py` joins it to the supervision; `simulation/` is the robot itself.

The words are those of micro-ROS system_modes and smart_polaris; the types of all of them are in
`lifecycle.py`, `system_model.py`, `messages.py` (what goes in and out) and `snapshot.py` (what can
be seen).
"""
