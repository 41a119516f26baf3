"""The faults of the network; what every link keeps is in tests/conformance/test_link.py."""

from collections.abc import AsyncIterator

import pytest

from domain.computers import SUPERVISOR, ComputerName
from domain.simulation.network import PERFECT, Wire
from domain.timebase import seconds
from service.link.memory import MemoryNetwork
from tests.support.links import RunningLink
from tests.support.manual_clock import ManualClock, settle

BASE = ComputerName("base")


class Two:
    """The supervisor and the base, on a clock that a test moves."""

    def __init__(self) -> None:
        self.clock = ManualClock(start=7)
        self.network = MemoryNetwork([SUPERVISOR, BASE], self.clock, seed=3)
        self.supervisor = RunningLink(SUPERVISOR, self.network.link(SUPERVISOR))
        self.base = RunningLink(BASE, self.network.link(BASE))

    async def heard(self, link: RunningLink) -> list[bytes]:
        await settle()
        return [message for _, message in link.received]


@pytest.fixture
async def two() -> AsyncIterator[Two]:
    two = Two()
    async with two.supervisor, two.base:
        yield two


async def test_a_message_arrives_after_the_delay_of_its_direction(two: Two) -> None:
    two.network.set_wire(BASE, SUPERVISOR, Wire(delay=seconds(0.2)))
    two.base.send(SUPERVISOR, b"slow")
    two.supervisor.send(BASE, b"at once")

    await two.clock.advance(0.19)
    assert await two.heard(two.base) == [b"at once"]
    assert await two.heard(two.supervisor) == []

    await two.clock.advance(0.01)
    assert await two.heard(two.supervisor) == [b"slow"]


async def test_a_cut_in_one_direction_leaves_the_other(two: Two) -> None:
    two.network.set_wire(BASE, SUPERVISOR, Wire(is_cut=True))
    two.base.send(SUPERVISOR, b"lost")
    two.supervisor.send(BASE, b"heard")

    assert await two.heard(two.supervisor) == []
    assert await two.heard(two.base) == [b"heard"]


async def test_a_cut_ends(two: Two) -> None:
    two.network.set_cut(BASE, SUPERVISOR, is_cut=True)
    two.base.send(SUPERVISOR, b"lost")
    two.supervisor.send(BASE, b"lost")
    await two.clock.advance(10.0)
    two.network.set_cut(BASE, SUPERVISOR, is_cut=False)
    two.base.send(SUPERVISOR, b"after")

    assert await two.heard(two.supervisor) == [b"after"]
    assert await two.heard(two.base) == []


async def test_what_a_cut_kept_arrives_when_it_ends(two: Two) -> None:
    two.network.set_wire(SUPERVISOR, BASE, Wire(is_cut=True, keeps=True))
    two.supervisor.send(BASE, b"an old order")
    await two.clock.advance(10.0)
    assert await two.heard(two.base) == []

    two.network.set_wire(SUPERVISOR, BASE, PERFECT)

    assert await two.heard(two.base) == [b"an old order"]


async def test_what_is_under_way_to_a_process_that_ends_is_lost(two: Two) -> None:
    two.network.set_wire(SUPERVISOR, BASE, Wire(delay=seconds(1.0)))
    two.supervisor.send(BASE, b"for the first process")
    await two.base.stop()

    async with RunningLink(BASE, two.network.link(BASE)) as again:
        await two.clock.advance(2.0)
        assert await two.heard(again) == []
