"""Rate, gap and age of topics, in virtual time."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from typing import TypeAlias

import pytest

from domain.inputs import Readings
from domain.timebase import NANOSECONDS_PER_SECOND, seconds
from service.clock import since_epoch
from service.files.robot_file import robot_settings_of
from service.ros.backend.topic_statistics import MAX_ARRIVALS, PERIOD_S, TopicStatistics
from service.ros.graph.graph import Lane
from tests.support.manual_clock import ManualClock
from tests.support.models import actuation_model
from tests.support.ros_graph import FakeGraph

Block: TypeAlias = Mapping[str, object]

SCAN = {"topic": "/scan", "type": "sensor_msgs/msg/LaserScan"}
RATE: Block = {**SCAN, "statistic": "rate", "window_s": 2.0}
GAP: Block = {**SCAN, "statistic": "gap", "window_s": 2.0}
AGE: Block = {**SCAN, "statistic": "age"}


class Robot:
    """A robot whose scan is watched, and what was heard of it."""

    def __init__(self, **statistics: Block) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock)
        self.heard: list[Readings] = []
        sent = {"signals": {name: {} for name in statistics}, "ros2": {"statistics": statistics}}
        settings = robot_settings_of(sent, actuation_model())
        self.statistics = TopicStatistics(settings, self.graph, self.clock)
        self.statistics.start()
        self._running = asyncio.create_task(self.statistics.run(self.heard.append))

    async def end(self) -> None:
        self._running.cancel()
        await asyncio.wait([self._running])

    async def scan(self, rate_hz: float, for_s: float, delay_s: float = 0.0) -> None:
        """Publish scans that were measured `delay_s` ago."""
        for _ in range(round(rate_hz * for_s)):
            await self.clock.advance(1 / rate_hz)
            wall = since_epoch(self.clock.wall_time(self.clock.now() - seconds(delay_s)))
            sec, nanosec = divmod(wall, NANOSECONDS_PER_SECOND)
            stamp = {"sec": sec, "nanosec": nanosec}
            self.graph.publish("/scan", {"header": {"stamp": stamp}})

    def newest(self, signal: str) -> object:
        values = {item.signal: item.value for readings in self.heard for item in readings.items}
        return values.get(signal)


@pytest.fixture
async def robot() -> AsyncIterator[Robot]:
    made = Robot(scan_rate=RATE, scan_gap=GAP, scan_age=AGE)
    yield made
    await made.end()


async def test_the_rate_of_a_steady_topic_is_right_within_two_percent(robot: Robot) -> None:
    await robot.scan(30, for_s=5)

    assert robot.newest("scan_rate") == pytest.approx(30, rel=0.02)
    assert robot.newest("scan_gap") == pytest.approx(1 / 30, rel=0.02)


async def test_rate_and_gap_are_not_known_before_their_window_has_passed(robot: Robot) -> None:
    await robot.scan(10, for_s=1.5)

    assert robot.newest("scan_rate") is None
    assert robot.newest("scan_gap") is None


async def test_a_topic_that_falls_silent_is_told_without_a_message(robot: Robot) -> None:
    await robot.scan(10, for_s=3)
    await robot.clock.advance(5)

    assert robot.newest("scan_rate") == 0.0
    assert robot.newest("scan_gap") == pytest.approx(5, abs=PERIOD_S)


async def test_the_age_is_that_of_the_stamp_and_not_of_the_arrival(robot: Robot) -> None:
    await robot.scan(10, for_s=3, delay_s=0.7)

    assert robot.newest("scan_age") == pytest.approx(0.7, abs=PERIOD_S)


async def test_a_stamp_ahead_of_our_clock_is_no_negative_age(robot: Robot) -> None:
    await robot.scan(10, for_s=3, delay_s=-10)

    assert robot.newest("scan_age") == 0.0


async def test_messages_without_a_stamp_have_no_age(robot: Robot) -> None:
    robot.graph.publish("/scan", {"ranges": []})
    await robot.clock.advance(1)

    assert robot.newest("scan_age") is None


async def test_several_statistics_of_a_topic_are_one_subscription(robot: Robot) -> None:
    await robot.scan(10, for_s=3)

    assert robot.graph.nodes == {"pilothouse_statistics": Lane.SENSORS}
    assert {readings.source for readings in robot.heard} == {"ros:/scan"}
    assert {item.signal for item in robot.heard[-1].items} == {
        "scan_rate",
        "scan_gap",
        "scan_age",
    }


async def test_more_messages_than_can_be_counted_leave_memory_bounded(robot: Robot) -> None:
    await robot.clock.advance(2)
    for _ in range(MAX_ARRIVALS + 5):
        robot.graph.publish("/scan", {})
    await robot.clock.advance(1)

    assert robot.newest("scan_rate") == MAX_ARRIVALS / 2


async def test_a_robot_without_statistics_joins_nothing() -> None:
    robot = Robot()
    await robot.clock.advance(1)

    assert robot.graph.nodes == {}
    await robot.end()
