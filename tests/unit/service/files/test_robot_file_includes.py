"""Robot files that include templates."""

import pytest

from domain.errors import InvalidValueError
from domain.findings import Finding
from domain.health.signals import SignalSettings
from service.files.monitor_templates import TEMPLATES, read_template
from service.files.robot_file import (
    InvalidRobotFileError,
    RobotSettings,
    read_robot_file,
    robot_settings_of,
    written_out,
)
from tests.support.models import actuation_model

MODEL = actuation_model()
SCAN = "{name: scan, topic: /scan, type: sensor_msgs/msg/LaserScan, min_hz: 8.0, max_gap_s: 0.5}"
REQUIRED = {
    "name": "scan",
    "topic": "/scan",
    "type": "sensor_msgs/msg/LaserScan",
    "min_hz": 8.0,
    "max_gap_s": 0.5,
    "interface": "eth0",
}


def _finding(text: str) -> Finding:
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(text, MODEL)
    return caught.value.findings[0]


def _declared(settings: RobotSettings) -> dict[str, SignalSettings]:
    return {signal.spec.name: signal for signal in settings.to_signal_settings()[5:]}


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_template_is_read(name: str) -> None:
    required = {key: REQUIRED[key] for key in read_template(name).requires}

    settings = robot_settings_of({"include": [{name: required}]}, MODEL)

    assert _declared(settings)


@pytest.mark.parametrize("name", ["topic", "camera", "lidar", "gps", "motor"])
def test_the_errors_of_a_template_are_of_the_part_that_is_named(name: str) -> None:
    required = {key: REQUIRED[key] for key in read_template(name).requires}
    parameters = {**required, "part": "drive_base", "severity": "warning"}

    settings = robot_settings_of({"include": [{name: parameters}]}, MODEL)

    assert {str(signal.part) for signal in _declared(settings).values()} == {"drive_base"}
    assert {str(signal.severity) for signal in _declared(settings).values()} == {"warning"}


def test_a_file_includes_templates_by_name_or_with_parameters() -> None:
    text = (
        f"include:\n  - motor\n  - topic: {SCAN}\nsignals:\n  motor_temperature: {{above: 70.0}}\n"
    )

    settings = read_robot_file(text, MODEL)

    assert _declared(settings)["motor_temperature"].bounds[0].threshold == 70.0
    assert set(settings.ros2.statistics) == {"scan_rate", "scan_gap"}


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("include: [cpuu]", (1, 11), "there is no template 'cpuu'; did you mean cpu?"),
        ("include: cpu", (1, 1), "expected a list of templates"),
        (
            "include:\n  - disk\n  - disk: {pth: /}\n",
            (3, 12),
            "the template disk has no parameter 'pth'; did you mean path?",
        ),
        ("include:\n  - disk: {high: x}\n", (2, 5), "signals.disk_used.above"),
        ("include:\n  - motor: {part: nobody}\n", (2, 5), "nobody"),
        ("include: [motor]\nsignals:\n  motor_temperature: {unitt: K}\n", (3, 23), "unitt"),
        (
            "include: [motor]\nsignals:\n  motor_temperature: {maximum: 50.0}\n",
            (1, 11),
            "threshold of motor_temperature can never be reached",
        ),
        (
            f"include:\n  - topic: {SCAN}\nros2:\n  statistics: {{}}\n  signals: []\n",
            (5, 3),
            "ros2",
        ),
    ],
)
def test_a_finding_is_at_the_line_that_causes_it(
    text: str, place: tuple[int, int], words: str
) -> None:
    finding = _finding(text)

    assert (finding.line, finding.column) == place, finding
    assert words in finding.message


@pytest.mark.parametrize(
    ("data", "pointer"),
    [
        ({"include": ["cpuu"]}, "/include/0"),
        ({"include": ["cpu", {"disk": {"pth": "/"}}]}, "/include/1/disk/pth"),
        ({"include": [{"disk": {"high": "x"}}]}, "/include/0"),
        ({"include": [{"motor": {"part": "nobody"}}]}, "/include/0"),
    ],
)
def test_a_fault_in_what_was_sent_is_told_with_a_pointer(
    data: dict[str, object], pointer: str
) -> None:
    with pytest.raises(InvalidValueError) as caught:
        robot_settings_of(data, MODEL)

    assert caught.value.pointer == pointer


def test_a_log_keeps_what_the_templates_said() -> None:
    """A later release may have other ones."""
    text = f"name: carrier\ninclude:\n  - topic: {SCAN}\nsignals:\n  scan_rate: {{below: 9.0}}\n"

    kept = written_out(text)

    assert "include" not in kept
    before, after = read_robot_file(text, MODEL), read_robot_file(kept, MODEL)
    assert after.to_signal_settings() == before.to_signal_settings()
    assert (after.ros2, after.name) == (before.ros2, "carrier")


@pytest.mark.parametrize(
    "text", ["", "# nothing\n", "signals: {load: {unit: kg}}\n", "include: []"]
)
def test_a_log_keeps_a_file_without_includes_as_it_is(text: str) -> None:
    assert written_out(text) == text
