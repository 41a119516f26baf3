"""Robots that show what the built-in one does not: faults, many parts, long names."""

from pathlib import Path

MODES = ("__DEFAULT__", "FAST")
LONG = "front_left_wheel_speed_and_slip_observer_of_the_second_generation"

TROUBLED = """\
nodes:
  manipulator: {fault: die}
changes: {transition_deadline_s: 2.0}
vehicle: {plant: {braking_mps2: 0.05}}
signals:
  estop: {recovery: acknowledge}
  load: {above: 2500.0, unit: kg, error: OVERLOAD, stale_after_s: 0}
"""
"""A dead arm, weak brakes, a stop that wants acknowledging, and a signal that nobody sends."""


def troubled_robot(folder: Path) -> tuple[str, ...]:
    """Return arguments of `pilothouse serve` for the example with faults."""
    robot = folder / "troubled.yaml"
    robot.write_text(TROUBLED)
    return ("--robot", str(robot))


def large_robot(folder: Path, nodes: int = 100) -> tuple[str, ...]:
    """Return arguments of `pilothouse serve` for a robot of many nodes, one with a long name."""
    names = [LONG, *(f"node_{number:03}" for number in range(1, nodes))]
    modes = (f"{mode}: {{ros__parameters: {{speed: {mode == 'FAST'}}}}}" for mode in MODES)
    of_a_node = f"ros__parameters: {{type: node, modes: {{{', '.join(modes)}}}}}"
    parts = "".join(f"        {name}: active\n" for name in names)
    model = folder / "large.yaml"
    model.write_text(
        f"{LONG}_system:\n  ros__parameters:\n    type: system\n    parts: {names}\n"
        f"    modes:\n      __DEFAULT__:\n{parts}"
        + "".join(f"{name}:\n  {of_a_node}\n" for name in names)
    )
    return (str(model),)
