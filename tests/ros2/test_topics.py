"""Signals and vehicle over real topics: somebody else publishes, and hears what we publish."""

import asyncio
import math
from collections.abc import AsyncIterator, Callable
from typing import TYPE_CHECKING, Any

import pytest

from domain.commands import Drive
from domain.inputs import DriveStatus, ErrorReport, Readings, SignalValue, VehicleReport
from domain.vehicle import DriveCommand, VehicleLimits
from service.clock import MonotonicClock
from service.files.robot_file import robot_settings_of
from service.files.ros2_block import DiagnosticsBlock, Ros2Block
from service.ros.backend.diagnostics import ReportedDiagnostics
from service.ros.backend.signals import SignalTopics
from service.ros.backend.topic_statistics import TopicStatistics
from service.ros.backend.vehicle import RosVehicle
from service.ros.graph.graph import Fields, Lane, Message, Qos, RosNode, UnknownTypeError
from tests.support.models import actuation_model
from tests.support.waiting import until

if TYPE_CHECKING:
    from service.ros.graph.link import RosLink

pytestmark = pytest.mark.ros2

LIMITS = VehicleLimits(wheelbase_m=2.0)
PAUSE_S = 0.02
# Since 1970; years ago, and exact in a float.
STAMP_S = 1_700_000_000.25
HEADER = {"stamp": {"sec": 1_700_000_000, "nanosec": 250_000_000}}
NAN = float("nan")


@pytest.fixture
async def link() -> "AsyncIterator[RosLink]":
    from service.ros.graph.link import RosLink

    link = RosLink()
    yield link
    await link.close()


@pytest.fixture
async def somebody() -> AsyncIterator[RosNode]:
    """Return a node of somebody else."""
    from service.ros.graph.link import RosLink

    link = RosLink()
    yield link.node("somebody", Lane.SENSORS)
    await link.close()


def every_time(*publish: Callable[[], None], until_it_is: Callable[[], bool]) -> Callable[[], bool]:
    """Publish again before each look: who publishes once is not found yet."""

    def look() -> bool:
        for each in publish:
            each()
        return until_it_is()

    return look


def signal_topics(link: "RosLink", **signals: dict[str, object]) -> SignalTopics:
    sent = {"signals": {"wind": {"unit": "m/s"}}, "ros2": {"signals": signals}}
    return SignalTopics(robot_settings_of(sent, actuation_model()), link, MonotonicClock())


def vehicle(link: "RosLink", **block: object) -> RosVehicle:
    return RosVehicle(Ros2Block.model_validate(block), LIMITS, link, MonotonicClock())


SIGNALS: dict[str, tuple[dict[str, object], dict[str, Any], SignalValue]] = {
    "battery_level": (
        {"topic": "/battery_state", "type": "sensor_msgs/msg/BatteryState"},
        {"header": HEADER, "percentage": 0.75},
        0.75,
    ),
    "gps_accuracy": (
        {"topic": "/fix", "type": "sensor_msgs/msg/NavSatFix"},
        {
            "header": HEADER,
            "status": {"status": 0},
            "position_covariance": [0.0009, 0.0, 0.0, 0.0, 0.0016, 0.0, 0.0, 0.0, 9.0],
            "position_covariance_type": 2,
        },
        50.0,
    ),
    "temperature": (
        {"topic": "/motor/temperature", "type": "sensor_msgs/msg/Temperature"},
        {"header": HEADER, "temperature": 31.5},
        31.5,
    ),
    "estop": ({"topic": "/estop", "type": "std_msgs/msg/Bool"}, {"data": True}, True),
    "signal_strength": (
        {"topic": "/signal_strength", "type": "std_msgs/msg/UInt8"},
        {"data": 2},
        "LOW_SIGNAL",
    ),
    "wind": (
        {
            "topic": "/joint_states",
            "type": "sensor_msgs/msg/JointState",
            "field": "effort.1",
            "scale": 2.0,
        },
        {"effort": [1.0, 4.0]},
        8.0,
    ),
}


async def test_each_signal_is_read_from_messages_of_its_type(
    link: "RosLink", somebody: RosNode
) -> None:
    heard: list[Readings] = []
    topics = signal_topics(link, **{name: topic for name, (topic, _, _) in SIGNALS.items()})
    topics.start(heard.append)
    publish = [publishes(somebody, topic, fields) for topic, fields, _ in SIGNALS.values()]

    def values() -> dict[str, SignalValue]:
        return {readings.items[0].signal: readings.items[0].value for readings in heard}

    await until(every_time(*publish, until_it_is=lambda: len(values()) == len(SIGNALS)), PAUSE_S)

    assert values() == {
        name: pytest.approx(value) if isinstance(value, float) else value
        for name, (_, _, value) in SIGNALS.items()
    }
    sources = {readings.items[0].signal: readings.source for readings in heard}
    assert sources == {name: f"ros:{topic['topic']}" for name, (topic, _, _) in SIGNALS.items()}


FULL = 1.0000001
"""The next number above 1 in single precision, which is the type of the message."""


@pytest.mark.parametrize(
    ("signal", "topic", "fields", "value"),
    [
        ("battery_level", SIGNALS["battery_level"][0], {"percentage": FULL}, 1.0),
        ("estop", {**SIGNALS["estop"][0], "type": "std_msgs/msg/UInt8"}, {"data": 1}, True),
        (
            "estop",
            {"topic": "/estop", "type": "std_msgs/msg/String", "field": "data"},
            {"data": "TRUE"},
            True,
        ),
    ],
)
async def test_the_rounding_of_a_full_battery_and_other_types_of_a_stop_are_taken(
    link: "RosLink",
    somebody: RosNode,
    signal: str,
    topic: dict[str, object],
    fields: dict[str, Any],
    value: SignalValue,
) -> None:
    heard: list[Readings] = []
    signal_topics(link, **{signal: topic}).start(heard.append)
    publish = publishes(somebody, topic, fields)
    await until(every_time(publish, until_it_is=lambda: bool(heard)), PAUSE_S)

    assert heard[0].items[0].value == value


async def test_a_reading_has_the_stamp_of_its_header(link: "RosLink", somebody: RosNode) -> None:
    clock = MonotonicClock()
    topic, fields, _ = SIGNALS["temperature"]
    heard: list[Readings] = []
    signal_topics(link, temperature=topic).start(heard.append)
    publish = publishes(somebody, topic, fields)
    await until(every_time(publish, until_it_is=lambda: bool(heard)), PAUSE_S)

    stamp = heard[0].items[0].stamp
    assert stamp is not None
    # The two clocks of this machine were compared at two times, which may differ a little.
    assert clock.wall_time(stamp).timestamp() == pytest.approx(STAMP_S, abs=1.0)


async def test_what_was_not_measured_is_no_reading(link: "RosLink", somebody: RosNode) -> None:
    topic, _, _ = SIGNALS["battery_level"]
    heard: list[Readings] = []
    signal_topics(link, battery_level=topic).start(heard.append)
    publish = [publishes(somebody, topic, {"percentage": value}) for value in (NAN, 0.5)]
    await until(every_time(*publish, until_it_is=lambda: len(heard) >= 3), PAUSE_S)

    assert {readings.items[0].value for readings in heard} == {0.5}


async def test_odometry_says_how_the_vehicle_moves(link: "RosLink", somebody: RosNode) -> None:
    heard: list[VehicleReport | DriveStatus] = []
    vehicle(link, odometry={"topic": "/odom"}).start(heard.append)
    turn = {"z": math.sin(0.6), "w": math.cos(0.6)}
    fields = {
        "pose": {"pose": {"position": {"x": 12.0, "y": -3.0}, "orientation": turn}},
        "twist": {"twist": {"linear": {"x": 2.0}, "angular": {"z": math.tan(0.3)}}},
    }
    publish = publishes(somebody, {"topic": "/odom", "type": "nav_msgs/msg/Odometry"}, fields)
    await until(every_time(publish, until_it_is=lambda: bool(heard)), PAUSE_S)

    report = heard[0]
    assert isinstance(report, VehicleReport)
    state = report.state
    assert (state.pose.x_m, state.pose.y_m, state.speed_mps) == (12.0, -3.0, 2.0)
    assert state.pose.yaw_rad == pytest.approx(1.2)
    assert state.steering_angle_rad == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("command", "inner"),
    [
        ("geometry_msgs/msg/Twist", lambda message: message),
        ("geometry_msgs/msg/TwistStamped", lambda message: message.twist),
    ],
)
async def test_a_command_to_drive_is_heard_as_a_twist(
    link: "RosLink", somebody: RosNode, command: str, inner: Callable[[Message], Message]
) -> None:
    heard: list[Message] = []
    somebody.subscribe("/cmd_vel", command, Qos.EVENTS, lambda message: message, heard.append)
    robot = vehicle(link, command={"topic": "/cmd_vel", "type": command})
    robot.start(lambda _: None)
    running = asyncio.create_task(robot.run())

    def drive() -> None:
        robot.send(Drive(DriveCommand(1.5, 0.3)))

    await until(every_time(drive, until_it_is=lambda: bool(heard)), PAUSE_S)
    running.cancel()
    await asyncio.wait([running])

    twist = inner(heard[0])
    assert (twist.linear.x, twist.linear.y) == (1.5, 0.0)
    assert twist.angular.z == pytest.approx(1.5 * math.tan(0.3) / LIMITS.wheelbase_m)


async def test_what_is_not_installed_is_told_at_the_start(link: "RosLink") -> None:
    robot = vehicle(link, command={"topic": "/cmd", "type": "ackermann_msgs/msg/AckermannDrive"})
    with pytest.raises(
        UnknownTypeError, match=r"ackermann_msgs/msg/AckermannDrive is not installed"
    ):
        robot.start(lambda _: None)


def publishes(node: RosNode, topic: dict[str, Any], fields: Fields) -> Callable[[], None]:
    """Return what publishes a message on a topic, each time that it is called."""
    publisher = node.publisher(topic["topic"], topic["type"], Qos.EVENTS)
    return lambda: publisher.publish(fields)


async def test_the_rate_of_a_real_topic_is_right(link: "RosLink", somebody: RosNode) -> None:
    watched = {"topic": "/scan", "type": "sensor_msgs/msg/LaserScan"}
    sent = {
        "signals": {"scan_rate": {}, "scan_age": {}},
        "ros2": {
            "statistics": {
                "scan_rate": {**watched, "statistic": "rate", "window_s": 2.0},
                "scan_age": {**watched, "statistic": "age"},
            }
        },
    }
    statistics = TopicStatistics(robot_settings_of(sent, actuation_model()), link, MonotonicClock())
    values: dict[str, float] = {}

    def take(readings: Readings) -> None:
        values.update((item.signal, float(item.value)) for item in readings.items)

    statistics.start()
    running = asyncio.create_task(statistics.run(take))
    publisher = somebody.publisher("/scan", "sensor_msgs/msg/LaserScan", Qos.SENSOR)
    loop = asyncio.get_running_loop()
    due = loop.time()
    for _ in range(150):
        due += 1 / 30
        await asyncio.sleep(max(0.0, due - loop.time()))
        publisher.publish({"header": HEADER})
    running.cancel()

    # A busy machine may be late with a message or two at either end of the window.
    assert values["scan_rate"] == pytest.approx(30, abs=2)
    assert values["scan_age"] > 1e6


async def test_a_real_message_of_diagnostics_is_an_error_of_a_part(
    link: "RosLink", somebody: RosNode
) -> None:
    settings = DiagnosticsBlock.model_validate({"errors": {"lidar_driver: Link": "lidar.LINK"}})
    heard: list[ErrorReport] = []
    ReportedDiagnostics(settings, link).start(heard.append)
    publisher = somebody.publisher(
        "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", Qos.EVENTS
    )
    array = {"status": [{"name": "lidar_driver: Link", "level": 2, "message": "cable"}]}

    await until(
        every_time(lambda: publisher.publish(array), until_it_is=lambda: bool(heard)), PAUSE_S
    )

    assert [(r.part, r.error, r.active, r.message) for r in heard] == [
        ("lidar", "LINK", True, "lidar_driver: Link: ERROR: cable")
    ]
