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


AREAS = {
    "perception": ("camera", "lidar", "radar", "camera_wheel", "detector"),
    "motion": ("motor", "encoder", "brake", "steering_observer", "imu"),
    "power": ("cell_monitor", "converter", "charger", "fan", "fuse"),
}
PER_UNIT = 10


CROWDED_FAULTS = {
    "motion/unit_04/brake_002": "die",
    "power/unit_08/fan_003": "error",
    "motion/unit_10/imu_004": "die",
}


def crowded_robot(folder: Path, nodes: int = 300, *, faulty: bool = False) -> tuple[str, ...]:
    """Return arguments of `pilothouse serve` for nodes in namespaces and in nested systems.

    The robot `carrier` consists of areas, an area of units with ten nodes each; the node
    `motion/shared_clock` is in the systems `motion` and `power`. `faulty`: with CROWDED_FAULTS.
    """
    shared = "motion/shared_clock"
    units: dict[str, list[str]] = {}
    for number in range(nodes - 1):
        unit, place = divmod(number, PER_UNIT)
        area = list(AREAS)[unit % len(AREAS)]
        kinds = AREAS[area]
        name = f"{area}/unit_{unit:02}/{kinds[place % len(kinds)]}_{place:03}"
        units.setdefault(f"{area}_unit_{unit:02}", []).append(name)
    areas = {
        area: [unit for unit in units if unit.startswith(f"{area}_unit")]
        + ([shared] if area != "perception" else [])
        for area in AREAS
    }
    systems = {"carrier": list(AREAS), **areas, **units}
    of_a_node = (
        "{ros__parameters: {type: node, modes: {"
        "__DEFAULT__: {ros__parameters: {rate: 10}}, SLOW: {ros__parameters: {rate: 2}}}}}"
    )
    lines = []
    for system, parts in systems.items():
        wanted = ", ".join(f"{part}: active" for part in parts)
        lines.append(
            f"{system}: {{ros__parameters: {{type: system, modes: {{__DEFAULT__: {{{wanted}}}}}}}}}"
        )
    lines += [f"{node}: {of_a_node}" for unit in units.values() for node in unit]
    lines.append(f"{shared}: {of_a_node}")
    model, robot = folder / f"crowded_{nodes}.yaml", folder / "crowded_robot.yaml"
    model.write_text("\n".join(lines) + "\n")
    faults = (f"  {node}: {{fault: {fault}}}\n" for node, fault in CROWDED_FAULTS.items())
    robot.write_text(f"nodes:\n{''.join(faults)}")
    return (str(model), *(("--robot", str(robot)) if faulty else ()))


GUARDED = """\
mobile_manipulation:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {drive_base: active, arm: inactive, GRIPPER: inactive}
      CAREFUL: {drive_base: active.SLOW, arm: active, GRIPPER: active}
      MANIPULATE: {drive_base: active.SLOW, arm: active.STRONG, GRIPPER: active}
      TRANSPORT: {drive_base: active.FAST, arm: active, GRIPPER: active}
    mode_settings:
      CAREFUL:
        transition: {order: sequential, sequence: [drive_base, arm, GRIPPER], deadline_s: 20}
      MANIPULATE:
        requires:
          - "battery_level >= 0.3 and (arm.state != finalized or hold.operator)"
          - "drive_base.reachable"
        invariants: ["temperature < 50"]
        fallback: CAREFUL
        transition: {after: {arm: [drive_base], GRIPPER: [drive_base]}, on_failure: rollback}
      TRANSPORT:
        requires: ["signal_strength == CONNECTED"]
drive_base:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {max_speed: 0.1}}
      SLOW: {ros__parameters: {max_speed: 0.2}}
      FAST: {ros__parameters: {max_speed: 0.9}}
arm:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {max_torque: 0.1}}
      STRONG: {ros__parameters: {max_torque: 0.2}}
GRIPPER:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {force: 5.0}}
"""
"""Modes that require something, go in stages, fall back and roll back."""


def guarded_robot(folder: Path, fault: str | None = None) -> tuple[str, ...]:
    """Return arguments of `pilothouse serve` for a robot whose modes have guards and an order.

    The node with the long name, which begins last, has `fault`.
    """
    model, robot = folder / "guarded.yaml", folder / f"guarded_{fault}.yaml"
    model.write_text(GUARDED.replace("GRIPPER", LONG))
    settings = f"nodes: {{{LONG}: {{fault: {fault}}}}}\n" if fault else ""
    robot.write_text(f"{settings}changes: {{transition_deadline_s: 2.0}}\n")
    return (str(model), "--robot", str(robot))


def many_signals_robot(folder: Path, count: int = 200) -> tuple[str, ...]:
    """Return arguments of `pilothouse serve` for the example with further signals, to be posted."""
    robot = folder / "many_signals.yaml"
    limits = "above: 80.0, clear_threshold: 70.0, unit: °C, stale_after_s: 0, severity: urgent"
    signals = [
        f"  motor_{number:03}_temperature: {{{limits}, error: HOT_{number:03}}}"
        for number in range(count)
    ]
    mean = "of: motor_000_temperature, statistic: mean, window_s: 10.0, label: mean of motor 0"
    robot.write_text("\n".join(["signals:", *signals, f"  motor_mean: {{{mean}}}", ""]))
    return ("--robot", str(robot))
