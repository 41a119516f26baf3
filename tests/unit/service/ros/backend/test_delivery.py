import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.inputs import NodeReport, Reading, Readings, ReportBacklog, VehicleReport
from domain.timebase import Instant, seconds
from domain.vehicle import Pose, VehicleState
from service.ports import BackendMessage
from service.ros.backend.delivery import Delivery
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import ARM, BASE
from tests.support.waiting import until

ROOM = 2_000
PRESSED = Readings((Reading("estop", value=True),), "ros:/estop")
RELEASED = Readings((Reading("estop", value=False),), "ros:/estop")
WARM = Readings((Reading("temperature", 30.0),), "ros:/temperature")
AT_REST = VehicleReport(VehicleState(Pose(0.0, 0.0, 0.0), 0.0, 0.0))


def reports(count: int) -> list[BackendMessage]:
    return [NodeReport(BASE, parameters={"max_speed": float(n)}) for n in range(count)]


class Robot:
    """A delivery that runs, and what it delivered."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.delivery = Delivery(ROOM, self.clock)
        self.heard: list[BackendMessage] = []
        self.backlogs: list[Instant | None] = []

    def deliver(self, message: BackendMessage) -> None:
        if isinstance(message, ReportBacklog):
            self.backlogs.append(message.since)
        else:
            self.heard.append(message)

    def hear(self, *messages: BackendMessage) -> None:
        for message in messages:
            self.delivery.put(message)


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    robot = Robot()
    run = asyncio.create_task(robot.delivery.run(robot.deliver))
    await settle()
    yield robot
    run.cancel()
    await asyncio.wait([run])


async def test_an_emergency_stop_goes_before_what_was_heard_earlier(robot: Robot) -> None:
    earlier = reports(1_000)
    robot.hear(*earlier, AT_REST, WARM, PRESSED, RELEASED)
    await settle()

    assert robot.heard == [PRESSED, RELEASED, AT_REST, WARM, *earlier]


async def test_who_listens_knows_from_when_reports_of_nodes_wait(robot: Robot) -> None:
    robot.hear(*reports(500))
    robot.clock.stall(1.0)
    robot.hear(*reports(500))
    await until(lambda: len(robot.heard) > 750)
    assert robot.backlogs == [-1, seconds(1.0) - 1], "all that arrived before is delivered"
    await settle()
    assert robot.backlogs[2:] == [None]
    robot.hear(*reports(2), AT_REST)
    await settle()
    assert robot.backlogs[3:] == [], "what one turn delivers does not wait"


async def test_in_the_middle_of_a_storm_it_is_next(robot: Robot) -> None:
    robot.hear(*reports(1_000))
    await asyncio.sleep(0)
    robot.hear(PRESSED)
    before = len(robot.heard)
    await until(lambda: PRESSED in robot.heard)

    assert 0 < before < 1_000
    assert robot.heard.index(PRESSED) == before


async def test_reports_of_nodes_keep_their_order(robot: Robot) -> None:
    sent = [*reports(7), NodeReport(ARM, reachable=False), *reports(7)]
    robot.hear(*sent)
    await settle()

    assert robot.heard == sent


async def test_others_get_their_turn_meanwhile(robot: Robot) -> None:
    robot.hear(*reports(1_000))
    turns = 0
    while len(robot.heard) < 1_000:
        await asyncio.sleep(0)
        turns += 1

    assert turns >= 200


async def test_what_is_raised_over_a_message_ends_it() -> None:
    def fail(_: BackendMessage) -> None:
        raise ZeroDivisionError

    delivery = Delivery(ROOM, ManualClock())
    delivery.put(PRESSED)

    with pytest.raises(ZeroDivisionError):
        await delivery.run(fail)


async def test_what_waits_is_bounded_and_leaves_room_for_an_emergency_stop() -> None:
    robot = Robot()
    robot.hear(*reports(ROOM))
    with pytest.raises(asyncio.QueueFull):
        robot.hear(*reports(1))
    robot.hear(PRESSED)
