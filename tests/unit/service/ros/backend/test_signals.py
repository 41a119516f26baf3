import logging
import math
import re
from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
import pytest

from domain.inputs import Reading, Readings, SignalValue
from domain.timebase import seconds
from service.clock import EPOCH, since_epoch
from service.files.robot_file import robot_settings_of
from service.ros.backend.signals import SignalTopics
from service.ros.graph.graph import Lane, Qos, UnknownTypeError
from tests.support.live_robot import make_supervisor
from tests.support.manual_clock import START, ManualClock
from tests.support.models import actuation_model
from tests.support.ros_graph import FakeGraph

Topic: TypeAlias = Mapping[str, object]

BATTERY = {"topic": "/battery_state", "type": "sensor_msgs/msg/BatteryState"}
ESTOP = {"topic": "/estop", "type": "std_msgs/msg/Bool"}
FIX = {"topic": "/fix", "type": "sensor_msgs/msg/NavSatFix"}
TEMPERATURE = {"topic": "/motor/temperature", "type": "sensor_msgs/msg/Temperature"}
STRENGTH = {"topic": "/signal_strength", "type": "std_msgs/msg/UInt8"}
WIND = {"topic": "/wind", "type": "weather_msgs/msg/Wind", "field": "layers.1.speed"}
NAN = float("nan")


class Robot:
    """A robot whose signals have topics, and what was heard of them."""

    def __init__(self, **signals: Topic) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock, missing=("weather_msgs/msg/Storm",))
        self.heard: list[Readings] = []
        sent = {"signals": {"wind": {"minimum": 0.0}}, "ros2": {"signals": signals}}
        settings = robot_settings_of(sent, actuation_model())
        self.topics = SignalTopics(settings, self.graph, self.clock)

    def start(self) -> None:
        self.topics.start(self.heard.append)

    def publish_all(self, topic: Topic, fields: Mapping[str, object]) -> None:
        self.graph.publish(str(topic["topic"]), fields)

    def publish(self, topic: str, **fields: object) -> None:
        self.graph.publish(topic, fields)

    @property
    def readings(self) -> list[Reading]:
        return [reading for readings in self.heard for reading in readings.items]

    @property
    def values(self) -> list[SignalValue]:
        return [reading.value for reading in self.readings]


def running(**signals: Topic) -> Robot:
    robot = Robot(**signals)
    robot.start()
    return robot


def fix(east: float, north: float, status: int = 0, known: int = 2) -> dict[str, Any]:
    covariance = np.zeros(9)
    covariance[[0, 4]] = east, north
    return {
        "status": {"status": status},
        "position_covariance": covariance,
        "position_covariance_type": known,
    }


def complaints(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]


# --- what is read --------------------------------------------------------------------------------


def test_a_reading_tells_its_value_its_topic_and_no_time_where_the_message_has_none() -> None:
    robot = running(estop=ESTOP)
    robot.publish("/estop", data=True)

    assert robot.heard == [Readings((Reading("estop", value=True),), source="ros:/estop")]


@pytest.mark.parametrize(
    ("signal", "topic", "fields", "value"),
    [
        ("battery_level", BATTERY, {"percentage": 0.5}, 0.5),
        ("battery_level", {**BATTERY, "field": "charge", "scale": 0.01}, {"charge": 80.0}, 0.8),
        ("gps_accuracy", FIX, fix(0.0009, 0.0016), 50.0),
        ("gps_accuracy", {**FIX, "scale": 2.0}, fix(0.0009, 0.0016), 100.0),
        ("gps_accuracy", {**FIX, "field": "position_covariance.4"}, fix(3.0, 25.0), 25.0),
        ("temperature", TEMPERATURE, {"temperature": 31.5}, 31.5),
        ("temperature", {**TEMPERATURE, "offset": -273.15}, {"temperature": 300.0}, 26.85),
        ("estop", ESTOP, {"data": False}, False),
        ("estop", ESTOP, {"data": 1}, True),
        ("estop", {**ESTOP, "invert": True}, {"data": False}, True),
        ("estop", {**ESTOP, "invert": True}, {"data": True}, False),
        ("signal_strength", STRENGTH, {"data": 0}, "NOT_CONNECTED"),
        ("signal_strength", STRENGTH, {"data": 1}, "CONNECTED"),
        ("signal_strength", STRENGTH, {"data": 2}, "LOW_SIGNAL"),
        ("signal_strength", STRENGTH, {"data": "LOW_SIGNAL"}, "LOW_SIGNAL"),
        ("wind", WIND, {"layers": [{"speed": 1.0}, {"speed": 4}]}, 4.0),
        ("wind", {**WIND, "field": "speed"}, {"speed": b"\x07"}, 7.0),
        ("wind", {**WIND, "field": "speeds.0"}, {"speeds": np.array([3], dtype=np.uint8)}, 3.0),
    ],
)
def test_a_value_is_found_in_its_message(
    signal: str, topic: Topic, fields: dict[str, object], value: SignalValue
) -> None:
    robot = running(**{signal: topic})
    robot.publish_all(topic, fields)

    (reading,) = robot.readings
    assert reading.signal == signal
    assert type(reading.value) is type(value)
    assert reading.value == (pytest.approx(value) if isinstance(value, float) else value)


def test_the_time_in_the_header_is_that_of_the_reading() -> None:
    robot = running(temperature=TEMPERATURE)
    since_epoch_s = since_epoch(START) // 1_000_000_000
    header = {"stamp": {"sec": since_epoch_s + 3, "nanosec": 250_000_000}}
    robot.publish("/motor/temperature", temperature=20.0, header=header)

    assert [reading.stamp for reading in robot.readings] == [seconds(3.25)]


def test_a_time_of_0_in_the_header_says_nothing() -> None:
    robot = running(temperature=TEMPERATURE)
    header = {"stamp": {"sec": 0, "nanosec": 0}}
    robot.publish("/motor/temperature", temperature=20.0, header=header)

    assert [reading.stamp for reading in robot.readings] == [None]


def test_a_clock_that_began_at_0_is_taken_as_it_is() -> None:
    robot = running(temperature=TEMPERATURE)
    header = {"stamp": {"sec": 0, "nanosec": 1_000}}
    robot.publish("/motor/temperature", temperature=20.0, header=header)

    assert [reading.stamp for reading in robot.readings] == [robot.clock.from_wall(EPOCH) + 1_000]


def test_two_signals_may_come_with_the_same_messages() -> None:
    inside = {**BATTERY, "field": "temperature"}
    robot = running(battery_level=BATTERY, temperature=inside)
    robot.publish("/battery_state", percentage=0.5, temperature=30.0)

    assert [(r.signal, r.value) for r in robot.readings] == [
        ("battery_level", 0.5),
        ("temperature", 30.0),
    ]


def test_topics_are_heard_as_sensors_are_by_one_node() -> None:
    robot = running(estop=ESTOP, battery_level=BATTERY)

    assert robot.graph.nodes == {"pilothouse_signals": Lane.SENSORS}
    assert robot.graph.qos == {"/estop": Qos.SENSOR, "/battery_state": Qos.SENSOR}
    assert robot.graph.types == {
        "/estop": "std_msgs/msg/Bool",
        "/battery_state": "sensor_msgs/msg/BatteryState",
    }


def test_a_robot_without_topics_needs_no_node() -> None:
    assert running().graph.nodes == {}


def test_a_type_that_is_not_installed_is_told_at_the_start() -> None:
    robot = Robot(estop=ESTOP, wind={**WIND, "type": "weather_msgs/msg/Storm"})

    with pytest.raises(UnknownTypeError, match="weather_msgs"):
        robot.start()


# --- what is no reading --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("signal", "topic", "fields"),
    [
        pytest.param("battery_level", BATTERY, {"percentage": NAN}, id="a charge not measured"),
        pytest.param("gps_accuracy", FIX, fix(0.01, 0.01, status=-1), id="no fix"),
        pytest.param("gps_accuracy", FIX, fix(0.01, 0.01, known=0), id="a covariance not known"),
        pytest.param("gps_accuracy", FIX, fix(NAN, 0.01), id="no number"),
        pytest.param("gps_accuracy", FIX, fix(-1.0, 0.01), id="a variance below 0"),
        pytest.param("gps_accuracy", FIX, fix(math.inf, 0.01), id="without bounds"),
        pytest.param("temperature", TEMPERATURE, {"temperature": math.inf}, id="no temperature"),
    ],
)
def test_what_was_not_measured_is_no_reading_and_nothing_to_complain_of(
    signal: str,
    topic: Topic,
    fields: dict[str, object],
    caplog: pytest.LogCaptureFixture,
) -> None:
    robot = running(**{signal: topic})
    robot.publish_all(topic, fields)

    assert robot.heard == []
    assert complaints(caplog) == []


@pytest.mark.parametrize(
    ("signal", "topic", "fields", "words"),
    [
        ("battery_level", BATTERY, {"percentage": 80.0}, "battery_level must be at most 1"),
        ("gps_accuracy", {**FIX, "field": "speed"}, {"speed": -1.0}, "must be at least 0"),
        ("estop", ESTOP, {"data": 2}, "estop must be true or false, not 2"),
        ("estop", {**ESTOP, "invert": True}, {"data": 1}, "not .1, inverted."),
        ("estop", {**ESTOP, "invert": True}, {"data": 0}, "not .0, inverted."),
        ("temperature", TEMPERATURE, {"temperature": True}, "must be a number, not True"),
        ("signal_strength", STRENGTH, {"data": 3}, "must be one of CONNECTED"),
        ("signal_strength", STRENGTH, {"data": True}, "must be one of CONNECTED"),
        ("temperature", {**TEMPERATURE, "field": "of"}, {"of": [{"x": 1.0}]}, "must be a number"),
    ],
)
def test_what_a_signal_cannot_be_is_rejected_counted_and_logged_by_the_service(
    signal: str,
    topic: Topic,
    fields: dict[str, object],
    words: str,
    caplog: pytest.LogCaptureFixture,
) -> None:
    supervisor = make_supervisor()
    robot = running(**{signal: topic})
    robot.publish_all(topic, fields)

    supervisor.deliver(robot.heard[0])

    assert supervisor.refused_readings.counts == {"ros": 1}
    (complaint,) = complaints(caplog)
    assert complaint.startswith(f"rejected a reading of ros:{topic['topic']}: ")
    assert re.search(words, complaint)


@pytest.mark.parametrize(
    ("signal", "topic", "fields", "words"),
    [
        ("battery_level", BATTERY, {"charge": 1.0}, "no such field: .*'percentage'"),
        ("wind", WIND, {"layers": [{"speed": 1.0}]}, "no such field: list index out"),
        ("wind", WIND, {"layers": 3}, "no such field: 'int'"),
    ],
)
def test_a_message_without_the_field_is_no_reading_and_is_told(
    signal: str,
    topic: Topic,
    fields: dict[str, object],
    words: str,
    caplog: pytest.LogCaptureFixture,
) -> None:
    robot = running(**{signal: topic})
    robot.publish_all(topic, fields)

    assert robot.heard == []
    (complaint,) = complaints(caplog)
    assert complaint.startswith(f"{topic['topic']} ({topic['type']}) is not accepted as {signal}: ")
    assert re.search(words, complaint)


async def test_a_topic_is_complained_of_once_a_minute_and_others_by_themselves(
    caplog: pytest.LogCaptureFixture,
) -> None:
    robot = running(battery_level=BATTERY, estop=ESTOP)
    for _ in range(1_210):
        robot.publish("/battery_state", charge=0.8)
        await robot.clock.advance(0.1)
    robot.publish("/estop", on=True)

    assert ["battery" in complaint for complaint in complaints(caplog)] == [True, True, True, False]


# --- what comes too often ------------------------------------------------------------------------


async def test_of_a_topic_that_comes_a_thousand_times_a_second_fifty_are_taken() -> None:
    robot = running(temperature=TEMPERATURE)
    for count in range(5_000):
        robot.publish("/motor/temperature", temperature=float(count % 50))
        await robot.clock.advance(0.001)

    assert 5 * 50 <= len(robot.values) <= 5 * 50 + 11


async def test_a_topic_that_comes_fifty_times_a_second_loses_nothing_by_jitter() -> None:
    robot = running(temperature=TEMPERATURE)
    for count in range(100):
        robot.publish("/motor/temperature", temperature=float(count))
        await robot.clock.advance(0.019 if count % 2 else 0.021)

    assert robot.values == [float(count) for count in range(100)]


def test_a_few_messages_at_once_are_all_taken_so_that_the_last_one_holds() -> None:
    robot = running(temperature=TEMPERATURE)
    for value in (20.0, 40.0, 60.0):
        robot.publish("/motor/temperature", temperature=value)

    assert robot.values == [20.0, 40.0, 60.0]


async def test_an_estop_is_never_left_out_however_often_it_comes() -> None:
    robot = running(estop=ESTOP)
    for count in range(1_000):
        robot.publish("/estop", data=count in {500, 700, 701})
        await robot.clock.advance(0.001)

    pressed = [index for index, value in enumerate(robot.values) if value]
    changes = [b for a, b in zip(robot.values, robot.values[1:], strict=False) if a is not b]
    assert changes == [True, False, True, False]
    assert len(pressed) in {2, 3}
    assert len(robot.values) < 70


async def test_a_word_that_changes_is_never_left_out() -> None:
    robot = running(signal_strength=STRENGTH)
    for count in range(1_000):
        robot.publish("/signal_strength", data=2 if count == 500 else 1)
        await robot.clock.advance(0.001)

    assert robot.values.count("LOW_SIGNAL") == 1
    assert robot.values[-1] == "CONNECTED"
