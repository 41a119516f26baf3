"""What is wrong in the graph is told once, as soon as it is sure."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.graph_terms import GraphFault, GraphFaultKind
from service.ros.backend.graph_watch import DOUBLED_FOR, GraphWatch
from tests.support.manual_clock import ManualClock, settle
from tests.support.ros_graph import FakeGraph

SCAN = GraphFault(GraphFaultKind.QOS, "/scan", "no message of /lidar arrives")
BASE = GraphFault(GraphFaultKind.DUPLICATE, "/base", "2 nodes have this name")


class Watching:
    """A graph, who watches it, and what was told."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock)
        self.watch = GraphWatch(self.graph, self.clock)
        self.told: list[GraphFault] = []

    async def see(self, *faults: GraphFault, for_s: float) -> list[GraphFault]:
        """Let this be wrong for a time; return what is told meanwhile."""
        self.graph.faults[:] = faults
        self.told.clear()
        await self.clock.advance(for_s)
        return [*self.told]


@pytest.fixture
async def robot() -> AsyncIterator[Watching]:
    watching = Watching()
    running = asyncio.create_task(watching.watch.run(watching.told.append))
    await settle()
    yield watching
    running.cancel()
    await asyncio.gather(running, return_exceptions=True)


async def test_a_topic_whose_ends_do_not_match_is_told_within_a_second(robot: Watching) -> None:
    assert await robot.see(SCAN, for_s=1.0) == [SCAN]
    assert await robot.see(SCAN, for_s=10.0) == []
    assert await robot.see(for_s=1.0) == [GraphFault(GraphFaultKind.QOS, "/scan")]
    assert await robot.see(for_s=10.0) == []


async def test_another_reason_is_told_anew(robot: Watching) -> None:
    await robot.see(SCAN, for_s=1.0)
    other = GraphFault(GraphFaultKind.QOS, "/scan", "no message of /radar arrives")

    assert await robot.see(other, for_s=1.0) == [other]


async def test_a_node_that_was_restarted_after_a_crash_is_not_told(robot: Watching) -> None:
    assert await robot.see(BASE, for_s=21.0) == []
    assert await robot.see(for_s=60.0) == []


async def test_two_nodes_of_one_name_are_told_when_both_stay(robot: Watching) -> None:
    assert await robot.see(BASE, for_s=29.0) == []
    assert await robot.see(BASE, for_s=3.0) == [BASE]
    assert await robot.see(for_s=1.0) == [GraphFault(GraphFaultKind.DUPLICATE, "/base")]


async def test_a_crash_now_and_another_one_later_are_no_double(robot: Watching) -> None:
    assert DOUBLED_FOR > 25e9
    for _ in range(3):
        assert await robot.see(BASE, for_s=21.0) == []
        assert await robot.see(for_s=2.0) == []
