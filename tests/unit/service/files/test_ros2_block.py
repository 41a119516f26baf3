from typing import Any

import pytest
from pydantic import ValidationError

from domain.errors import InvalidValueError
from domain.timebase import seconds
from service.files.model_file import read_model
from service.files.robot_file import InvalidRobotFileError, read_robot_file, robot_settings_of
from service.files.ros2_block import Ros2Block, SignalTopicBlock, StatisticBlock
from tests.support.models import actuation_model

MODEL = actuation_model()
FLOAT = "std_msgs/msg/Float64"


def topic(**keys: object) -> SignalTopicBlock:
    return SignalTopicBlock.model_validate({"topic": "/t", "type": FLOAT, **keys})


def faults(text: str) -> list[tuple[int | None, int | None, str]]:
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(text, MODEL)
    return [(f.line, f.column, f.code) for f in caught.value.findings]


def test_a_robot_of_which_nothing_is_said_has_no_topics() -> None:
    block = read_robot_file("backend: ros2\n", MODEL).ros2

    assert (block.signals, block.odometry, block.command) == ({}, None, None)


def test_messages_are_our_own_unless_the_file_names_those_of_smart_polaris() -> None:
    assert read_robot_file("", MODEL).ros2.messages == "pilothouse_msgs"
    given = read_robot_file("ros2: {messages: gem_state_msgs}\n", MODEL)
    assert given.ros2.messages == "gem_state_msgs"

    assert faults("ros2: {messages: my_msgs}\n") == [(1, 8, "INVALID_VALUE")]


def test_topics_of_signals_vehicle_and_commands_hold() -> None:
    settings = read_robot_file(
        """
backend: ros2
signals:
  motor_current: {unit: A}
ros2:
  signals:
    battery_level: {topic: /battery_state, type: sensor_msgs/msg/BatteryState, scale: 0.01}
    estop: {topic: /pacmod/as_tx/enable, type: std_msgs/msg/Bool, invert: true}
    motor_current: {topic: /left/motor_2, type: left_msgs/msg/Motor, field: phases.2.current}
  odometry: {topic: /odom}
  command: {topic: /cmd_vel, type: geometry_msgs/msg/TwistStamped}
""",
        MODEL,
    )

    assert settings.backend == "ros2"
    battery, estop, motor = settings.ros2.signals.values()
    assert (battery.topic, battery.path, battery.scale) == ("/battery_state", ("percentage",), 0.01)
    assert (estop.path, estop.invert) == (("data",), True)
    assert (motor.type, motor.path) == ("left_msgs/msg/Motor", ("phases", 2, "current"))
    assert settings.ros2.odometry is not None
    assert settings.ros2.odometry.topic == "/odom"
    assert settings.ros2.command is not None
    assert settings.ros2.command.type == "geometry_msgs/msg/TwistStamped"


@pytest.mark.parametrize(
    ("type_name", "path"),
    [
        ("sensor_msgs/msg/BatteryState", ("percentage",)),
        ("sensor_msgs/msg/Temperature", ("temperature",)),
        ("std_msgs/msg/Bool", ("data",)),
        ("std_msgs/msg/UInt8", ("data",)),
        ("std_msgs/msg/Int64", ("data",)),
        ("std_msgs/msg/Float32", ("data",)),
        ("std_msgs/msg/String", ("data",)),
        ("sensor_msgs/msg/NavSatFix", None),
    ],
)
def test_usual_types_have_a_usual_field(type_name: str, path: tuple[str, ...] | None) -> None:
    assert topic(type=type_name).path == path


def test_a_field_that_is_named_is_taken_instead_of_the_usual_one() -> None:
    fix = topic(type="sensor_msgs/msg/NavSatFix", field="position_covariance.0")

    assert fix.path == ("position_covariance", 0)
    assert topic(type="sensor_msgs/msg/BatteryState", field="temperature").path == ("temperature",)


@pytest.mark.parametrize("type_name", ["sensor_msgs/msg/Imu", "std_msgs/msg/Header"])
def test_of_another_type_the_field_has_to_be_named(type_name: str) -> None:
    with pytest.raises(ValidationError, match=f"{type_name} has no default field"):
        topic(type=type_name)


@pytest.mark.parametrize(
    ("key", "wrong"),
    [
        ("topic", "battery_state"),
        ("topic", "/"),
        ("topic", "/battery_state/"),
        ("topic", "/2nd"),
        ("topic", "~/battery"),
        ("topic", "/battery\n"),
        ("topic", "/" + "a" * 247),
        ("type", "Bool"),
        ("type", "std_msgs/Bool"),
        ("type", "std_msgs/srv/Empty"),
        ("type", "std_msgs/msg/bool"),
        ("field", ""),
        ("field", "0"),
        ("field", "data."),
        ("field", "data[0]"),
        ("field", "position_covariance.-1"),
        ("field", "__class__"),
    ],
)
def test_a_name_that_ros_does_not_know_is_refused_with_an_example(key: str, wrong: str) -> None:
    with pytest.raises(
        ValidationError, match=r"invalid (topic name|message type|field) .*such as "
    ) as caught:
        topic(**{key: wrong})

    (fault,) = caught.value.errors()
    assert fault["loc"] == (key,)


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({"odometry": {}}, "Field required"),
        ({"command": {"topic": "/cmd_vel"}}, "Field required"),
        ({"command": {"topic": "/cmd_vel", "type": "std_msgs/msg/Bool"}}, "Twist"),
        ({"signals": {"estop": {"topic": "/estop"}}}, "Field required"),
        ({"odometry": {"topic": "/odom", "type": "nav_msgs/msg/Odometry"}}, "not permitted"),
        ({"topics": {}}, "not permitted"),
    ],
)
def test_a_block_that_is_not_whole_or_says_too_much_is_refused(
    block: dict[str, Any], words: str
) -> None:
    with pytest.raises(ValidationError, match=words):
        Ros2Block.model_validate(block)


@pytest.mark.parametrize(
    ("line", "column", "code"),
    [
        pytest.param("tail: {topic: /t, type: std_msgs/msg/Bool}", 5, "UNKNOWN_SIGNAL", id="name"),
        pytest.param(
            "estop: {topic: /t, type: std_msgs/msg/Bool, scale: 2}",
            49,
            "INVALID_VALUE",
            id="a boolean that is scaled",
        ),
        pytest.param(
            "signal_strength: {topic: /t, type: std_msgs/msg/UInt8, offset: 1}",
            60,
            "INVALID_VALUE",
            id="a word that is moved",
        ),
        pytest.param(
            "temperature: {topic: /t, type: std_msgs/msg/Float32, invert: yes}",
            58,
            "INVALID_VALUE",
            id="a number that is inverted",
        ),
        pytest.param("estop: {topic: t, type: std_msgs/msg/Bool}", 13, "INVALID_VALUE", id="topic"),
        pytest.param("estop: {topic: /t, type: a/msg/B}", 5, "INVALID_VALUE", id="no field"),
    ],
)
def test_a_fault_is_told_with_its_place(line: str, column: int, code: str) -> None:
    assert faults(f"ros2:\n  signals:\n    {line}\n") == [(3, column, code)]


def test_all_faults_of_the_signals_are_told_at_once() -> None:
    text = """
ros2:
  signals:
    tail: {topic: /t, type: std_msgs/msg/Bool}
    horn: {topic: /t, type: std_msgs/msg/Bool}
nodes: {wing: {}}
"""

    assert faults(text) == [
        (4, 5, "UNKNOWN_SIGNAL"),
        (5, 5, "UNKNOWN_SIGNAL"),
        (6, 9, "UNKNOWN_NODE"),
    ]


def test_a_topic_has_one_type() -> None:
    text = """
ros2:
  signals:
    estop: {topic: /a, type: std_msgs/msg/Bool}
    temperature: {topic: /a, type: std_msgs/msg/Float64}
"""

    assert faults(text) == [(5, 30, "INVALID_VALUE")]


def test_a_fault_in_what_was_sent_is_told_with_a_pointer() -> None:
    sent = {"ros2": {"signals": {"tail": {"topic": "/t", "type": "std_msgs/msg/Bool"}}}}
    with pytest.raises(InvalidValueError, match="there is no signal 'tail'; declare it") as caught:
        robot_settings_of(sent, MODEL)

    assert caught.value.pointer == "/ros2/signals/tail"


def test_a_signal_that_is_declared_may_have_a_topic() -> None:
    sent = {
        "signals": {"wind": {"unit": "m/s"}},
        "ros2": {"signals": {"wind": {"topic": "/wind", "type": FLOAT, "offset": -1}}},
    }

    assert robot_settings_of(sent, MODEL).ros2.signals["wind"].offset == -1.0


DIAGNOSTICS = """
lidar:
  ros__parameters:
    type: node
    errors:
      LINK: {hint: look at the cable}
      SILENT: {when: "not lidar.reachable"}
"""


@pytest.mark.parametrize(
    ("error", "code"),
    [
        ("lidar.LINK", None),
        ("/lidar.LINK", None),
        ("lidar.SILENT", "INVALID_VALUE"),
        ("lidar.UNREACHABLE", "UNKNOWN_ERROR"),
        ("lidar.NONE", "UNKNOWN_ERROR"),
        ("camera.LINK", "UNKNOWN_PART"),
        ("LINK", "INVALID_VALUE"),
    ],
)
def test_diagnostics_report_errors_that_the_model_leaves_to_others(
    error: str, code: str | None
) -> None:
    text = f"ros2:\n  diagnostics:\n    errors:\n      'lidar_driver: Connection': {error}\n"
    model = read_model(DIAGNOSTICS).model

    if code is None:
        assert read_robot_file(text, model).ros2.diagnostics is not None
        return
    with pytest.raises(InvalidRobotFileError) as caught:
        read_robot_file(text, model)
    (finding,) = caught.value.findings
    assert (finding.line, finding.code) == (4, code)


def test_statistics_are_of_declared_numbers_and_of_nothing_that_has_another_source() -> None:
    text = """
signals:
  scan_rate: {}
  scan_gap: {}
  slow: {of: scan_rate, statistic: mean, window_s: 5}
ros2:
  signals:
    scan_gap: {topic: /gap, type: std_msgs/msg/Float64}
  statistics:
    scan_rate: {topic: /scan, type: sensor_msgs/msg/LaserScan, statistic: rate}
    scan_gap: {topic: /scan, type: sensor_msgs/msg/LaserScan, statistic: gap}
    estop: {topic: /scan, type: sensor_msgs/msg/LaserScan, statistic: rate}
    slow: {topic: /scan, type: sensor_msgs/msg/LaserScan, statistic: rate}
    other: {topic: /scan, type: sensor_msgs/msg/Image, statistic: age}
"""
    assert faults(text) == [
        (11, 5, "INVALID_VALUE"),
        (12, 5, "INVALID_VALUE"),
        (13, 5, "INVALID_VALUE"),
        (14, 5, "UNKNOWN_SIGNAL"),
        (14, 27, "INVALID_VALUE"),
    ]


def test_an_age_has_no_window() -> None:
    with pytest.raises(ValidationError, match="window_s is for rate and gap only"):
        StatisticBlock.model_validate(
            {"topic": "/t", "type": FLOAT, "statistic": "age", "window_s": 1}
        )


def test_an_external_controller_has_an_action_and_deadlines() -> None:
    block = read_robot_file("ros2: {navigation: {action: /go, silent_for_s: 0.5}}\n", MODEL).ros2
    assert block.navigation is not None
    assert block.navigation.type == "pilothouse_msgs/action/NavigateWaypoints"
    settings = block.navigation.to_settings()
    assert (settings.name, settings.silent_for) == ("/go", seconds(0.5))


@pytest.mark.parametrize(
    "said",
    [
        "{}",
        "{action: go}",
        "{action: /go, type: my_msgs/action/Go}",
        "{action: /go, silent_for_s: 0}",
        "{action: /go, taken_back_within_s: .inf}",
        "{action: /go, claim_tolerance_m: -1}",
        "{action: /go, deadline_s: 1}",
    ],
)
def test_a_controller_that_cannot_be_used_is_complained_of(said: str) -> None:
    with pytest.raises(InvalidRobotFileError):
        read_robot_file(f"ros2: {{navigation: {said}}}\n", MODEL)
