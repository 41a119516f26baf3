"""What the ends of the link are made of follows from the files that the computers share."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from typing import Any

import pytest

from domain.computers import SUPERVISOR, ComputerName, DeviceState
from domain.inputs import DeviceStatus, NodeReport, SupervisorStatus
from domain.parts.system_model import SmhModel
from service.link.device_end import DeviceEnd
from service.link.end import LinkEnd
from service.link.making import make_end, random_id, terms_of
from service.link.memory import MemoryNetwork
from service.link.place import place_in
from service.link.supervisor_end import SupervisorEnd
from service.ports import BackendMessage
from tests.support.linked_robot import DEVICES, names_of, settings_of
from tests.support.manual_clock import ManualClock
from tests.support.models import ARM, actuation_model, nested_model

THERE = ComputerName("arm")


class Ends:
    """The ends of computers that share a network, and what each delivered."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self._network = MemoryNetwork(names_of(), self.clock)
        self.delivered: dict[str, list[BackendMessage]] = {}
        self._running: list[asyncio.Task[None]] = []

    def start(
        self,
        name: str,
        model: SmhModel | None = None,
        devices: Mapping[str, Any] = DEVICES,
        **more: object,
    ) -> LinkEnd:
        """Make the end of a computer, and let it run."""
        model, robot = model or actuation_model(), settings_of(name, devices, **more)
        place = place_in(robot)
        assert place is not None
        link = self._network.link(ComputerName(name))
        end = make_end(place, model, robot, link, self.clock, "0.1.0")
        delivered: list[BackendMessage] = []
        self.delivered[name] = delivered
        self._running.append(asyncio.create_task(end.run(delivered.append), name=name))
        return end

    async def stop(self) -> None:
        """End them all."""
        for task in self._running:
            task.cancel()
        await asyncio.gather(*self._running, return_exceptions=True)

    def state_of(self, name: str) -> DeviceState:
        """Return how the connection is, as the computer of this name was last told."""
        statuses = [
            given
            for given in self.delivered[name]
            if isinstance(given, DeviceStatus | SupervisorStatus)
        ]
        return statuses[-1].state


@pytest.fixture
async def ends() -> AsyncIterator[Ends]:
    ends = Ends()
    yield ends
    await ends.stop()


async def test_a_device_and_the_supervisor_find_each_other(ends: Ends) -> None:
    supervisor = ends.start(SUPERVISOR, devices={"arm": DEVICES["arm"]})
    device = ends.start("arm", devices={"arm": DEVICES["arm"]})
    assert isinstance(device, DeviceEnd)
    device.note(NodeReport(ARM, reachable=True))
    await ends.clock.advance(1.0)

    assert isinstance(supervisor, SupervisorEnd)
    assert ends.state_of("arm") is DeviceState.CONNECTED
    assert ends.state_of(SUPERVISOR) is DeviceState.CONNECTED
    assert NodeReport(ARM, reachable=True) in ends.delivered[SUPERVISOR]
    assert supervisor.connection(THERE).lost_share == 0


async def test_computers_with_other_models_do_not_deal_with_each_other(ends: Ends) -> None:
    ends.start(SUPERVISOR)
    ends.start("arm", model=nested_model())
    await ends.clock.advance(1.0)

    assert ends.state_of("arm") is DeviceState.CONFLICT


async def test_computers_that_share_out_the_parts_otherwise_do_not_either(ends: Ends) -> None:
    ends.start(SUPERVISOR, link={"lost_s": 2})
    ends.start("arm", link={"lost_s": 3})
    await ends.clock.advance(1.0)

    assert ends.state_of("arm") is DeviceState.CONFLICT


async def test_where_they_listen_does_not_matter(ends: Ends) -> None:
    ends.start(SUPERVISOR, devices={"arm": DEVICES["arm"]})
    elsewhere = {"listen": ["tcp/127.0.0.1:1"], "lost_s": 1.5}
    device = ends.start("arm", devices={"arm": DEVICES["arm"]}, link=elsewhere)
    assert isinstance(device, DeviceEnd)
    device.note(NodeReport(ARM, reachable=True))
    await ends.clock.advance(1.0)

    assert ends.state_of("arm") is DeviceState.CONNECTED


def test_an_id_has_128_random_bits() -> None:
    first, second = random_id(), random_id()

    assert first != second
    assert len(bytes.fromhex(first)) == 16


def test_terms_say_the_version_for_people() -> None:
    assert terms_of(actuation_model(), settings_of(SUPERVISOR), "0.1.0").version == "0.1.0"
