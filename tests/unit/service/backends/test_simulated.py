import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.errors import UnknownParameterError, UnknownPartError
from domain.lifecycle import LifecycleState, Transition
from domain.messages import AskTransition, BackendStatus, NodeReport
from domain.simulation.node_settings import Fault
from domain.simulation.nodes import SimulatedNodes
from domain.system_model import PartName
from domain.timebase import to_seconds
from service.backends.simulated import SimulatedBackend
from service.ports import BackendMessage
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import ARM, BASE, actuation_model


class Listening:
    """A simulated backend that runs on a clock, and what was heard of it, when."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        nodes = SimulatedNodes(actuation_model(), {}, self.clock.now())
        self.backend = SimulatedBackend(nodes, self.clock)
        self.heard: list[tuple[float, BackendMessage]] = []

    def hear(self, message: BackendMessage) -> None:
        self.heard.append((to_seconds(self.clock.now()), message))


@pytest.fixture
async def listening() -> AsyncIterator[Listening]:
    listening = Listening()
    running = asyncio.create_task(listening.backend.run(listening.hear))
    await settle()
    yield listening
    running.cancel()
    await asyncio.wait([running])


async def test_it_is_there_before_its_nodes(listening: Listening) -> None:
    first, *others = [message for _, message in listening.heard]

    assert first == BackendStatus(available=True)
    assert {m.node for m in others if isinstance(m, NodeReport)} == {BASE, ARM}


async def test_a_node_arrives_exactly_after_its_time(listening: Listening) -> None:
    await listening.clock.advance(1.0)
    listening.backend.send(AskTransition(1, BASE, Transition.CONFIGURE))
    await listening.clock.advance(1.0)

    assert listening.heard[-1] == (1.3, NodeReport(BASE, state=LifecycleState.INACTIVE))


async def test_a_fault_takes_effect_at_once(listening: Listening) -> None:
    await listening.clock.advance(1.0)
    listening.backend.set_fault(BASE, Fault.DIE)
    await listening.clock.advance(5.0)

    assert listening.heard[-1] == (2.0, NodeReport(BASE, reachable=False))


async def test_a_parameter_changed_from_outside_is_heard_at_once(listening: Listening) -> None:
    listening.backend.set_parameters(BASE, {"max_speed": 0.3})
    await settle()

    assert listening.heard[-1] == (0.0, NodeReport(BASE, parameters={"max_speed": 0.3}))


async def test_what_cannot_be_is_refused_where_it_is_asked(listening: Listening) -> None:
    with pytest.raises(UnknownPartError):
        listening.backend.set_fault(PartName("nowhere"), Fault.DIE)
    with pytest.raises(UnknownParameterError):
        listening.backend.set_parameters(BASE, {"wheels": 4})
