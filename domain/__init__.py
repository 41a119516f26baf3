"""All decisions, and the simulated robot: deterministic, without I/O; the caller passes the time.

Read `supervision.py` first (one input and its consequences), then `parts/mode_inference.py` and the
packages `changes/` (requests and their steps), `health/` (signals and errors) and `tasks/` (tasks
and the holds that pause them). `navigation.py` follows a path with `paths/` and `tracking/`;
`onboard.py` connects it to the supervision; `simulation/` is the simulated robot.

The terms are those of micro-ROS system_modes and smart_polaris; their types are in `lifecycle.py`,
`parts/system_model.py`, `inputs.py`, `commands.py`, `events/` and `snapshot.py` (all that clients
can see).
"""
