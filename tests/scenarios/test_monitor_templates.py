"""Each template raises the errors of which its comment tells, and none while all is well."""

from collections.abc import Callable, Mapping

import pytest

from domain.supervision import SupervisionSettings
from service.files.monitor_templates import TEMPLATES, Parameter, read_template
from service.files.robot_file import robot_settings_of
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import actuation_model

Course = Callable[[float], float]
"""What a signal reads so many seconds after the start."""
STEP_S = 0.5

REQUIRED: Mapping[str, Mapping[str, Parameter]] = {
    "network": {"interface": "eth0"},
    "topic": {
        "name": "scan",
        "topic": "/scan",
        "type": "sensor_msgs/msg/LaserScan",
        "min_hz": 8.0,
        "max_gap_s": 0.5,
    },
}
WELL: Mapping[str, Mapping[str, float]] = {
    "battery": {"battery_level": 0.9},
    "camera": {"camera_rate": 30.0, "camera_age": 0.1},
    "clock": {"clock_offset": 0.001},
    "cpu": {"cpu_load": 50.0},
    "disk": {"disk_used": 50.0},
    "gps": {"gps_rate": 1.0, "gps_accuracy": 20.0},
    "lidar": {"lidar_rate": 10.0, "lidar_age": 0.1},
    "memory": {"memory_used": 50.0},
    "motor": {"motor_current": 5.0, "motor_temperature": 40.0},
    "network": {"network_up": 1.0, "network_errors": 0.0},
    "thermal": {"computer_temperature": 50.0},
    "topic": {"scan_rate": 10.0, "scan_gap": 0.1},
}


def _from(value: float, per_second: float = 0.0) -> Course:
    return lambda elapsed_s: value + per_second * elapsed_s


def _robot(template: str, courses: Mapping[str, Course], duration_s: float) -> CoreRobot:
    """Return a robot that includes a template, after signals have taken their courses."""
    include = [{template: dict(REQUIRED.get(template, {}))}]
    model = actuation_model()
    signals = robot_settings_of({"include": include}, model).to_signal_settings()
    robot = CoreRobot(model, SupervisionSettings(signals=signals))
    elapsed_s = 0.0
    while elapsed_s < duration_s:
        robot.read(**{**GOOD, **{name: course(elapsed_s) for name, course in courses.items()}})
        robot.advance(STEP_S)
        elapsed_s += STEP_S
    return robot


def _raised(robot: CoreRobot) -> set[str]:
    return {event["error"] for event in robot.happened("error.raised")}


@pytest.mark.parametrize("template", TEMPLATES)
def test_nothing_is_wrong_while_all_is_well(template: str) -> None:
    courses = {name: _from(value) for name, value in WELL[template].items()}

    assert _raised(_robot(template, courses, 100.0)) <= {"STALE_DATA"}


@pytest.mark.parametrize(
    ("template", "courses", "error", "after_s"),
    [
        ("battery", {"battery_level": _from(0.7, -0.002)}, "BATTERY_SHORT", 20),
        (
            "battery",
            {"battery_level": lambda at_s: 0.9 - 0.3 * (at_s > 3)},
            "BATTERY_GAUGE_JUMPS",
            5,
        ),
        ("camera", {"camera_rate": _from(5.0)}, "CAMERA_SLOW", 1),
        ("camera", {"camera_age": _from(1.0)}, "CAMERA_LATE", 2),
        ("clock", {"clock_offset": _from(0.2)}, "CLOCK_AHEAD", 2),
        ("clock", {"clock_offset": _from(-0.2)}, "CLOCK_BEHIND", 2),
        ("cpu", {"cpu_load": _from(95.0)}, "CPU_HIGH", 2),
        ("disk", {"disk_used": _from(95.0)}, "DISK_FULL", 1),
        ("disk", {"disk_used": _from(50.0, 0.02)}, "DISK_FILLS", 90),
        ("gps", {"gps_rate": _from(0.1)}, "GPS_SLOW", 1),
        ("gps", {"gps_accuracy": _from(150.0)}, "GPS_COARSE", 2),
        ("lidar", {"lidar_rate": _from(5.0)}, "LIDAR_SLOW", 1),
        ("lidar", {"lidar_age": _from(1.0)}, "LIDAR_LATE", 2),
        ("memory", {"memory_used": _from(95.0)}, "MEMORY_HIGH", 12),
        ("memory", {"memory_used": _from(50.0, 0.1)}, "MEMORY_RUNS_OUT", 30),
        ("motor", {"motor_current": _from(30.0)}, "MOTOR_OVERLOADED", 2),
        ("motor", {"motor_temperature": _from(95.0)}, "MOTOR_HOT", 1),
        ("motor", {"motor_temperature": _from(60.0, 0.5)}, "MOTOR_HEATS_UP", 15),
        ("network", {"network_up": _from(0.0)}, "NETWORK_DOWN", 3),
        ("network", {"network_errors": _from(5.0)}, "NETWORK_ERRORS", 2),
        ("thermal", {"computer_temperature": _from(90.0)}, "COMPUTER_HOT", 12),
        ("thermal", {"computer_temperature": _from(40.0, 0.5)}, "COMPUTER_HEATS_UP", 10),
        ("topic", {"scan_rate": _from(3.0)}, "SCAN_SLOW", 1),
        ("topic", {"scan_gap": _from(2.0)}, "SCAN_GAP", 1),
    ],
)
def test_an_error_is_raised_when_its_cause_comes(
    template: str, courses: Mapping[str, Course], error: str, after_s: float
) -> None:
    well = {name: _from(value) for name, value in WELL[template].items()}

    assert error in _raised(_robot(template, {**well, **courses}, after_s))


@pytest.mark.parametrize("per_second", [0.0, 0.002])
def test_a_battery_that_is_no_longer_used_is_not_short(per_second: float) -> None:
    """The time to its limit is unknown then, whether it rests or is charged."""

    def level(elapsed_s: float) -> float:
        if elapsed_s < 60.0:
            return 0.7 - 0.002 * elapsed_s
        return min(1.0, 0.58 + per_second * (elapsed_s - 60.0))

    robot = _robot("battery", {"battery_level": level}, 700.0)

    assert {event["error"] for event in robot.happened("error.cleared")} >= {"BATTERY_SHORT"}
    assert sum(event["error"] == "BATTERY_SHORT" for event in robot.happened("error.raised")) == 1


def test_every_error_of_a_template_has_a_row_here() -> None:
    # pytestmark has what the rows of the test above are.
    (mark,) = test_an_error_is_raised_when_its_cause_comes.pytestmark  # type: ignore[attr-defined]
    tried = {(template, error) for template, _, error, _ in mark.args[1]}
    declared = {
        (name, settings["error"])
        for name in TEMPLATES
        for settings in read_template(name).filled(REQUIRED.get(name, {}))["signals"].values()
        if "error" in settings
    }

    assert tried == declared
