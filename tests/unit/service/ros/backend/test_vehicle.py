import asyncio
import logging
import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from itertools import groupby
from typing import Any

import pytest

from domain.commands import Drive
from domain.inputs import DriveStatus, VehicleReport
from domain.timebase import to_seconds
from domain.vehicle import DriveCommand, Pose, VehicleLimits, VehicleState
from service.clock import since_epoch
from service.files.ros2_block import Ros2Block
from service.ros.backend.vehicle import RosVehicle
from service.ros.graph.drive import REPEATS
from service.ros.graph.graph import Fields, Lane, Qos, UnknownTypeError
from tests.support.manual_clock import START, ManualClock
from tests.support.ros_graph import FakeGraph

LIMITS = VehicleLimits(wheelbase_m=2.0, max_steering_angle_rad=0.5, max_speed_mps=4.0)
TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"
ACKERMANN = "ackermann_msgs/msg/AckermannDrive"
ACKERMANN_STAMPED = "ackermann_msgs/msg/AckermannDriveStamped"


class Robot:
    """A vehicle on `/odom` and `/cmd_vel`, and what was heard of it."""

    def __init__(
        self,
        *,
        odometry: bool = True,
        command: str | None = ACKERMANN,
        missing: tuple[str, ...] = (),
    ) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock, missing)
        self.heard: list[VehicleState] = []
        self.drive_statuses: list[DriveStatus] = []
        block: dict[str, object] = {}
        if odometry:
            block["odometry"] = {"topic": "/odom"}
        if command is not None:
            block["command"] = {"topic": "/cmd_vel", "type": command}
        settings = Ros2Block.model_validate(block)
        self.vehicle = RosVehicle(settings, LIMITS, self.graph, self.clock)

    def start(self) -> None:
        self.vehicle.start(self._hear)

    def _hear(self, report: VehicleReport | DriveStatus) -> None:
        if isinstance(report, VehicleReport):
            self.heard.append(report.state)
        else:
            self.drive_statuses.append(report)

    def drive(self, speed_mps: float, steering_angle_rad: float = 0.0) -> None:
        self.vehicle.send(Drive(DriveCommand(speed_mps, steering_angle_rad)))

    def report(self, **said: float) -> None:
        self.graph.publish("/odom", odometry(**said))

    @property
    def told(self) -> list[Fields]:
        return self.graph.published("/cmd_vel")

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        self.start()
        task = asyncio.create_task(self.vehicle.run(), name="vehicle under test")
        await self.clock.advance(0.0)
        yield
        task.cancel()
        await asyncio.wait([task])


def started(*, command: str | None = ACKERMANN) -> Robot:
    robot = Robot(command=command)
    robot.start()
    return robot


def odometry(
    x: float = 0.0,
    y: float = 0.0,
    yaw: float = 0.0,
    speed: float = 0.0,
    yaw_rate: float = 0.0,
    length: float = 1.0,
) -> dict[str, Any]:
    turn = {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2) * length, "w": math.cos(yaw / 2) * length}
    return {
        "pose": {"pose": {"position": {"x": x, "y": y, "z": 0.0}, "orientation": turn}},
        "twist": {"twist": {"linear": {"x": speed}, "angular": {"z": yaw_rate}}},
    }


def ackermann(speed_mps: float, steering_angle_rad: float = 0.0) -> Fields:
    return {"speed": speed_mps, "steering_angle": steering_angle_rad}


def complaints(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]


# --- how it moves --------------------------------------------------------------------------------


@pytest.mark.parametrize("yaw", [0.0, 0.5, -3.0, 3.14])
def test_odometry_says_where_the_vehicle_is_and_how_fast(yaw: float) -> None:
    robot = started()
    robot.report(x=12.0, y=-3.0, yaw=yaw, speed=1.5)

    (state,) = robot.heard
    assert (state.pose.x_m, state.pose.y_m, state.speed_mps) == (12.0, -3.0, 1.5)
    assert state.pose.yaw_rad == pytest.approx(yaw)


def test_a_heading_is_that_on_the_ground_though_the_vehicle_leans() -> None:
    # Turned by 1 rad, and then rolled by 0.2 rad about its own axis.
    cos, sin, cos_roll, sin_roll = math.cos(0.5), math.sin(0.5), math.cos(0.1), math.sin(0.1)
    message = odometry()
    message["pose"]["pose"]["orientation"] = {
        "x": cos * sin_roll,
        "y": sin * sin_roll,
        "z": sin * cos_roll,
        "w": cos * cos_roll,
    }
    robot = started()
    robot.graph.publish("/odom", message)

    assert robot.heard[0].pose.yaw_rad == pytest.approx(1.0)


@pytest.mark.parametrize("speed", [2.0, -2.0])
@pytest.mark.parametrize("steering", [0.3, -0.3])
def test_the_steering_angle_follows_from_how_quickly_it_turns(
    speed: float, steering: float
) -> None:
    robot = started()
    robot.drive(1.0, 0.1)
    robot.report(speed=speed, yaw_rate=speed * math.tan(steering) / LIMITS.wheelbase_m)

    assert robot.heard[0].steering_angle_rad == pytest.approx(steering)


def test_a_vehicle_that_spins_steers_no_further_than_it_can() -> None:
    robot = started()
    robot.report(speed=0.2, yaw_rate=-3.0)

    assert robot.heard[0].steering_angle_rad == -LIMITS.max_steering_angle_rad


@pytest.mark.parametrize("speed", [0.0, 0.1, -0.1])
async def test_a_vehicle_that_hardly_moves_steers_as_it_was_told(speed: float) -> None:
    robot = started()
    robot.report(speed=speed, yaw_rate=0.3)
    for told in (0.25, 9.0):
        robot.drive(1.0, told)
        await robot.clock.advance(0.1)
        robot.report(speed=speed, yaw_rate=0.3)

    assert [state.steering_angle_rad for state in robot.heard] == [0.0, 0.25, 0.5]


async def test_odometry_of_a_hundred_hertz_is_told_25_times_a_second() -> None:
    robot = started()
    for count in range(400):
        robot.report(x=float(count))
        await robot.clock.advance(0.01)

    assert 4 * 25 - 1 <= len(robot.heard) <= 4 * 25 + 1
    assert robot.heard[-1].pose.x_m >= 396.0


async def test_odometry_of_twenty_hertz_is_all_told() -> None:
    robot = started()
    for count in range(100):
        robot.report(x=float(count))
        await robot.clock.advance(0.04 if count % 2 else 0.06)

    assert [state.pose.x_m for state in robot.heard] == [float(count) for count in range(100)]


@pytest.mark.parametrize(
    "said",
    [
        {"x": math.nan},
        {"y": math.inf},
        {"yaw": math.nan},
        {"speed": -math.inf},
        {"yaw_rate": math.nan},
        {"length": 0.0},
        {"length": 1e200},
    ],
)
def test_odometry_that_is_no_number_is_told_to_nobody_but_the_log(
    said: dict[str, float], caplog: pytest.LogCaptureFixture
) -> None:
    robot = started()
    robot.report(**said)
    robot.report(x=1.0)

    assert [state.pose for state in robot.heard] == [Pose(1.0, 0.0, 0.0)]
    (complaint,) = complaints(caplog)
    assert complaint.startswith("invalid odometry on /odom")


async def test_odometry_is_complained_of_once_a_minute(caplog: pytest.LogCaptureFixture) -> None:
    robot = started()
    for _ in range(181):
        robot.report(x=math.nan)
        await robot.clock.advance(1.0)

    assert len(complaints(caplog)) == 4


# --- what it is told -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (ACKERMANN, {"speed": 2.0, "steering_angle": 0.3}),
        (TWIST, {"linear": {"x": 2.0}, "angular": {"z": 2.0 * math.tan(0.3) / 2.0}}),
    ],
)
def test_a_command_is_published_at_once(command: str, message: Fields) -> None:
    robot = started(command=command)
    robot.drive(2.0, 0.3)

    assert robot.told == [message]
    assert robot.graph.types["/cmd_vel"] == command


async def test_a_message_with_a_header_says_when_it_was_sent() -> None:
    robot = started(command=TWIST_STAMPED)
    await robot.clock.advance(2.25)
    robot.drive(-1.0)

    stamp = {"sec": since_epoch(START) // 1_000_000_000 + 2, "nanosec": 250_000_000}
    twist = {"linear": {"x": -1.0}, "angular": {"z": 0.0}}
    assert robot.told == [{"header": {"stamp": stamp}, "twist": twist}]


def test_an_ackermann_command_may_have_a_header_too() -> None:
    robot = Robot(command=ACKERMANN_STAMPED)
    robot.start()
    robot.drive(1.0, 0.2)

    stamp = {"sec": since_epoch(START) // 1_000_000_000, "nanosec": 0}
    assert robot.told == [{"header": {"stamp": stamp}, "drive": ackermann(1.0, 0.2)}]


@pytest.mark.parametrize(
    ("told", "possible"),
    [
        ((9.0, 0.1), (4.0, 0.1)),
        ((-9.0, 0.1), (-4.0, 0.1)),
        ((1.0, 2.0), (1.0, 0.5)),
        ((1.0, -2.0), (1.0, -0.5)),
    ],
)
def test_what_the_vehicle_cannot_do_is_cut(
    told: tuple[float, float], possible: tuple[float, float]
) -> None:
    robot = started()
    robot.drive(*told)

    assert robot.told == [ackermann(*possible)]


@pytest.mark.parametrize("told", [(math.nan, 0.1), (math.inf, 0.1), (1.0, math.nan)])
def test_a_command_that_is_no_number_is_a_stop_with_the_wheels_as_they_are(
    told: tuple[float, float],
) -> None:
    robot = started()
    robot.drive(1.0, 0.3)
    robot.drive(*told)

    assert robot.told[1:] == [ackermann(0.0, 0.3)]


async def test_half_a_second_after_the_last_command_it_is_told_for_2_s_to_stand_still() -> None:
    robot = Robot()
    async with robot.running():
        for _ in range(10):
            robot.drive(2.0, 0.2)
            await robot.clock.advance(0.05)
        await robot.clock.advance(0.44)
        assert robot.told == [ackermann(2.0, 0.2)] * 10

        await robot.clock.advance(0.01)
        assert robot.told[10:] == [ackermann(0.0, 0.2)]

        # Repeated, since a vehicle may have missed it; then another program can drive.
        await robot.clock.advance(10.0)
        assert robot.told[10:] == [ackermann(0.0, 0.2)] * REPEATS


async def test_who_was_told_to_stand_still_is_left_to_others() -> None:
    robot = Robot()
    async with robot.running():
        robot.drive(2.0)
        robot.drive(0.0)
        await robot.clock.advance(10.0)

    assert robot.told == [ackermann(2.0), ackermann(0.0)]


async def test_it_can_be_driven_again_after_it_was_stopped() -> None:
    robot = Robot()
    async with robot.running():
        robot.drive(2.0)
        await robot.clock.advance(1.0)
        robot.drive(1.0)
        await robot.clock.advance(1.0)

    speeds = [message["speed"] for message in robot.told]
    assert [speed for speed, _ in groupby(speeds)] == [2.0, 0.0, 1.0, 0.0]


async def test_a_vehicle_that_commands_do_not_reach_is_told_and_still_heard() -> None:
    robot = Robot()
    async with robot.running():
        (output,) = robot.graph.drive_outputs
        output.fail("the drive process has ended, and is started again")
        robot.report(x=1.0)
        output.fail("")

    assert [state.pose.x_m for state in robot.heard] == [1.0]
    assert robot.drive_statuses == [
        DriveStatus(available=True),
        DriveStatus(available=False, reason="the drive process has ended, and is started again"),
        DriveStatus(available=True),
    ]


def test_what_commands_a_vehicle_may_work_only_after_a_while() -> None:
    robot = Robot()
    robot.graph.drive_trouble = "the drive process is starting"
    robot.start()

    assert robot.drive_statuses == [DriveStatus(False, "the drive process is starting")]


def test_a_vehicle_that_is_only_watched_says_nothing_of_commands() -> None:
    assert started(command=None).drive_statuses == []


async def test_a_vehicle_that_is_driven_when_we_end_is_told_to_stand_still() -> None:
    robot = Robot()
    async with robot.running():
        robot.drive(2.0, 0.2)

    assert robot.told == [ackermann(2.0, 0.2), ackermann(0.0, 0.2)]
    assert to_seconds(robot.clock.now()) == 0.0


async def test_a_vehicle_that_nobody_drove_is_told_nothing_when_we_end() -> None:
    robot = Robot()
    async with robot.running():
        await robot.clock.advance(3.0)

    assert robot.told == []


# --- the topics ----------------------------------------------------------------------------------


def test_odometry_comes_as_sensors_do_and_an_old_command_is_not_kept() -> None:
    robot = started()

    assert robot.graph.nodes == {"pilothouse_vehicle": Lane.SENSORS}
    assert robot.graph.qos == {"/odom": Qos.SENSOR, "/cmd_vel": Qos.COMMANDS}
    assert robot.graph.types == {"/odom": "nav_msgs/msg/Odometry", "/cmd_vel": ACKERMANN}


async def test_a_vehicle_without_a_topic_for_commands_is_told_nothing() -> None:
    robot = Robot(command=None)
    async with robot.running():
        robot.drive(1.0, 0.2)
        robot.report(x=3.0)
        await robot.clock.advance(1.0)

    assert robot.graph.qos == {"/odom": Qos.SENSOR}
    assert robot.heard == [VehicleState(Pose(3.0, 0.0, 0.0), 0.0, 0.2)]


async def test_a_vehicle_without_odometry_is_driven_and_says_nothing() -> None:
    robot = Robot(odometry=False)
    async with robot.running():
        robot.drive(1.0)
        robot.report(x=3.0)

    assert robot.heard == []
    assert robot.told[0] == ackermann(1.0)


async def test_a_robot_without_a_vehicle_needs_no_node() -> None:
    robot = Robot(odometry=False, command=None)
    async with robot.running():
        robot.drive(1.0)
        await robot.clock.advance(1.0)

    assert robot.graph.nodes == {}


def test_a_command_before_the_start_does_no_harm() -> None:
    robot = Robot()
    robot.drive(1.0)
    robot.start()

    assert robot.told == []


def test_a_type_that_is_not_installed_is_told_at_the_start() -> None:
    robot = Robot(command=ACKERMANN_STAMPED, missing=(ACKERMANN_STAMPED,))

    with pytest.raises(UnknownTypeError, match="ackermann_msgs"):
        robot.start()
