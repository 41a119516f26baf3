from typing import Any

import pytest

from domain.actor import Actor
from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings
from domain.errors import ActsElsewhereError, InvalidValueError, OutdatedReadingError
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from service.ros.interface.interface import RosInterface
from service.ros.interface.settings import USUAL_SETTINGS
from tests.support.http_robot import http_robot
from tests.support.ros_robot import RosRobot

SENDER = Actor(way="rosbridge", address="192.0.2.7")


def send(robot: RosRobot, topic: str, fields: dict[str, Any]) -> None:
    robot.interface.heard[topic].take(fields, SENDER)


@pytest.mark.parametrize(
    ("topic", "type_name", "fields", "value"),
    [
        ("/battery_level", "BatteryLevel", {"battery_level": 0.75}, 0.75),
        ("/battery_level", "BatteryLevel", {"battery_level": 1}, 1.0),
        ("/estop", "EmergencyStop", {"enabled": True}, True),
        ("/gps_accuracy", "GpsAccuracy", {"accuracy": 42.0}, 42.0),
        ("/signal_strength", "SignalStrength", {"strength": 0}, "NOT_CONNECTED"),
        ("/signal_strength", "SignalStrength", {"strength": 1}, "CONNECTED"),
        ("/signal_strength", "SignalStrength", {"strength": 2}, "LOW_SIGNAL"),
        ("/temperature", "Temperature", {"temperature": -3.5}, -3.5),
    ],
)
async def test_a_message_is_a_reading_of_its_signal(
    robot: RosRobot, topic: str, type_name: str, fields: dict[str, Any], value: object
) -> None:
    send(robot, topic, fields)

    assert robot.interface.heard[topic].type == f"pilothouse_msgs/msg/{type_name}"
    view = robot.supervisor.core.signal(topic.removeprefix("/"))
    assert view.value == value
    assert view.source == SENDER.label


async def test_a_stamp_is_kept_and_zero_is_none(robot: RosRobot) -> None:
    stamp = {"sec": 1_767_225_600, "nanosec": 250_000_000}
    await robot.clock.advance(0.3)

    send(robot, "/temperature", {"header": {"stamp": stamp}, "temperature": 20.0})
    assert robot.supervisor.core.signal("temperature").stamp == 250_000_000

    zero = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "motor"}
    send(robot, "/temperature", {"header": zero, "temperature": 21.0})
    assert robot.supervisor.core.signal("temperature").stamp is None


async def test_one_sender_cannot_release_what_another_presses(robot: RosRobot) -> None:
    robot.interface.heard["/estop"].take({"enabled": True}, Actor("panel"))

    robot.interface.heard["/estop"].take({"enabled": False}, Actor("phone"))
    await robot.clock.advance(1.0)

    assert robot.supervisor.core.system_state().errors == ("ESTOP",)


@pytest.mark.parametrize(
    ("topic", "fields", "pointer"),
    [
        ("/battery_level", {"battery_level": 1.5}, "battery_level"),
        ("/battery_level", {"battery_level": float("nan")}, "battery_level"),
        ("/battery_level", {"level": 0.5}, "level"),
        ("/estop", {"enabled": 2}, "enabled"),
        ("/estop", {"enabled": False, "more": 1}, "more"),
        ("/estop", {"data": False}, "data"),
        ("/signal_strength", {"strength": 3}, "strength"),
        ("/temperature", {"temperature": 1.0, "header": {"stamp": 7}}, "header/stamp"),
    ],
)
async def test_a_message_that_cannot_be_right_is_refused(
    robot: RosRobot, topic: str, fields: dict[str, Any], pointer: str
) -> None:
    signal = topic.removeprefix("/")
    before = robot.supervisor.core.signal(signal).value

    with pytest.raises(InvalidValueError) as raised:
        send(robot, topic, fields)

    assert raised.value.pointer == pointer
    assert robot.supervisor.core.signal(signal).value == before


async def test_an_empty_message_does_not_release_an_estop(robot: RosRobot) -> None:
    send(robot, "/estop", {"enabled": True})

    with pytest.raises(InvalidValueError, match="enabled is missing"):
        send(robot, "/estop", {})

    assert robot.supervisor.core.signal("estop").value is True


async def test_an_older_message_is_refused_by_the_core(robot: RosRobot) -> None:
    newer = {"header": {"stamp": {"sec": 1_767_225_600}}, "temperature": 20.0}
    older = {"header": {"stamp": {"sec": 1_767_225_599}}, "temperature": 19.0}
    send(robot, "/temperature", newer)

    with pytest.raises(OutdatedReadingError):
        send(robot, "/temperature", older)


SHAPES: list[dict[str, Any]] = [
    {"header": {"seq": 1, "stamp": {"secs": 1, "nsecs": 0}, "frame_id": ""}},
    {"header": {"stamp": {"secs": 1_767_225_600, "nsecs": 5}}},
    {"header": {"stamp": {"sec": 1, "nanosec": 0}, "frame_id": "x"}},
    {"header": {"stamp": None, "frame_id": None, "seq": None}},
    {"header": {"stamp": {"secs": None, "nsecs": None}}},
    {"header": {"stamp": {}}},
    {"header": {}},
    {"header": None},
    {},
]
"""Headers as clients of ROS 1 and ROS 2 send them."""


@pytest.mark.parametrize("header", SHAPES)
@pytest.mark.parametrize(
    ("topic", "field", "value"),
    [("/battery_level", "battery_level", 0.7), ("/temperature", "temperature", 20.0),
     ("/gps_accuracy", "accuracy", 5.0), ("/signal_strength", "strength", 1),
     ("/estop", "enabled", False), ("/estop", "enabled", True)],
)  # fmt: skip
async def test_a_header_of_ros_1_or_2_is_taken_on_every_signal(
    robot: RosRobot, header: dict[str, Any], topic: str, field: str, value: object
) -> None:
    assert robot.interface.heard[topic].take({**header, field: value}, SENDER) is None

    assert robot.supervisor.core.signal(topic.removeprefix("/")).source == SENDER.label


@pytest.mark.parametrize(
    ("fields", "ignored"),
    [
        ({"header": 7}, "header must have fields by name"),
        ({"header": {"stamp": "noon"}}, "header/stamp must have fields by name"),
        ({"header": {"stamp": {"secs": -1}}}, "header/stamp/secs must be"),
        ({"header": {"who": "me"}}, "there is no field 'who'"),
        ({"more": [1]}, "there is no field 'more'"),
    ],
)
async def test_a_stop_is_taken_whatever_its_header_and_what_was_ignored_is_told(
    robot: RosRobot, fields: dict[str, Any], ignored: str
) -> None:
    told = robot.interface.heard["/estop"].take({**fields, "enabled": True}, SENDER)

    assert told is not None
    assert ignored in told
    assert robot.supervisor.core.system_state().errors == ("ESTOP",)


@pytest.mark.parametrize(
    "fields",
    [
        {"data": True},
        {"value": True},
        {"enabled": 1},
        {"msg": {"enabled": True}},
        {"enabled": {"data": True}},
        {"header": [{"enabled": "true"}], "enabled": False},
    ],
)
async def test_a_stop_may_be_asked_in_the_fields_of_other_types(
    robot: RosRobot, fields: dict[str, Any]
) -> None:
    send(robot, "/estop", fields)

    assert robot.supervisor.core.signal("estop").value is True


async def test_a_rejected_reading_is_counted_and_logged(
    robot: RosRobot, caplog: pytest.LogCaptureFixture
) -> None:
    with pytest.raises(InvalidValueError):
        send(robot, "/battery_level", {"battery_level": 7})

    assert robot.supervisor.refused_readings.counts == {"rosbridge": 1}
    assert "rejected a reading of rosbridge:192.0.2.7: battery_level" in caplog.text


async def test_a_topic_of_a_signal_that_a_device_reads_is_refused_and_a_stop_is_not() -> None:
    base = ComputerName("base")
    own = DeviceSettings(base, (PartName("drive_base"),), ("temperature", "estop"))
    settings = SupervisionSettings(devices={base: own})
    async with http_robot(mock=False, settings=settings) as robot:
        heard = RosInterface(robot.supervisor, USUAL_SETTINGS).heard
        with pytest.raises(ActsElsewhereError):
            heard["/temperature"].take({"temperature": 10.0}, SENDER)
        heard["/estop"].take({"enabled": True}, SENDER)
        with pytest.raises(ActsElsewhereError):
            heard["/estop"].take({"enabled": False}, SENDER)

        assert robot.supervisor.core.signal("temperature").value is None
        assert "ESTOP" in robot.supervisor.core.system_state().errors
        assert robot.supervisor.refused_readings.counts == {"rosbridge": 2}
