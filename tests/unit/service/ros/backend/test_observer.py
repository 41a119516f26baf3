import asyncio
import logging
from collections.abc import AsyncIterator

import pytest

from domain.lifecycle import LifecycleState, Transition
from domain.parts.system_model import NodeModel, SmhModel
from domain.state_and_mode import ModeName, PartName, StateAndMode
from service.ros.backend.observer import RosObserver
from service.ros.graph.graph import GraphFailedError, UnknownTypeError
from service.ros.interface.message_fields import mode_event
from tests.support.manual_clock import ManualClock, settle
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    FAST,
    MODERATE,
    PERFORMANCE,
    STRONG,
    active,
    actuation_model,
)
from tests.support.ros_graph import FakeGraph
from tests.support.ros_nodes import FakeNode

S, T = LifecycleState, Transition


class Observed:
    """An observer that runs in a graph in memory, and how often it told of something."""

    def __init__(self, model: SmhModel | None = None, *missing: str) -> None:
        self.clock = ManualClock()
        self.graph = FakeGraph(self.clock, missing)
        self.observer = RosObserver(model or actuation_model(), self.graph, self.clock)
        self.told = 0
        self.running: asyncio.Task[None] | None = None

    def node(
        self, name: PartName, state: LifecycleState = S.ACTIVE, **parameters: float | str
    ) -> FakeNode:
        """Start a node that is in a state already."""
        node = FakeNode(self.graph, name, parameters)
        node.state = state
        return node

    def base(self) -> FakeNode:
        return self.node(BASE, max_speed=0.9, controller="MPC")

    def arm(self) -> FakeNode:
        return self.node(ARM, max_torque=0.2)

    def _note(self) -> None:
        self.told += 1

    async def begin(self) -> None:
        self.running = asyncio.create_task(self.observer.run(self._note))
        await settle()

    async def end(self) -> None:
        if self.running is not None:
            self.running.cancel()
            await asyncio.wait([self.running])

    def actual(self, part: PartName) -> StateAndMode:
        return self.observer.parts.view(part).actual.state_and_mode

    def announce(self, part: PartName, mode: str) -> None:
        message = mode_event(self.clock.now(), None, ModeName(mode))
        self.graph.publish(f"/{part}/mode_request_info", message)


@pytest.fixture
async def observed() -> AsyncIterator[Observed]:
    made = Observed()
    yield made
    await made.end()


async def test_it_shows_what_the_nodes_are_in_without_a_service(observed: Observed) -> None:
    observed.base()
    observed.arm()
    await observed.begin()
    for part, mode in ((ACTUATION, PERFORMANCE), (BASE, FAST), (ARM, STRONG)):
        observed.announce(part, mode)
    await observed.clock.advance(1.5)

    assert observed.actual(ACTUATION) == active(PERFORMANCE)
    assert observed.actual(BASE) == active(FAST)
    assert observed.actual(ARM) == active(STRONG)
    assert observed.told > 0


async def test_it_follows_transitions_and_parameters(observed: Observed) -> None:
    base = observed.base()
    arm = observed.arm()
    await observed.begin()
    observed.announce(ACTUATION, PERFORMANCE)
    await observed.clock.advance(1.5)
    base.set({"max_speed": 0.2, "controller": "PID"})
    arm.set({"max_torque": 0.15})
    await observed.clock.advance(0.1)

    assert observed.actual(ACTUATION) == StateAndMode(S.ACTIVATING, MODERATE)

    base.move(T.DEACTIVATE)
    await observed.clock.advance(0.1)

    assert observed.actual(BASE) == StateAndMode(S.INACTIVE)


async def test_a_node_that_is_absent_or_dies_is_not_reachable(observed: Observed) -> None:
    base = observed.base()
    await observed.begin()
    await observed.clock.advance(1.5)

    view = observed.observer.parts.view
    assert (view(BASE).reachable, view(ARM).reachable) == (True, False)

    base.stop()
    await observed.clock.advance(4.0)

    assert not view(BASE).reachable
    assert view(ACTUATION).actual.reason == "drive_base is unreachable"


async def test_it_only_asks(observed: Observed) -> None:
    observed.base()
    await observed.begin()
    observed.announce(ACTUATION, PERFORMANCE)
    await observed.clock.advance(10.0)

    services = {request.service.rpartition("/")[2] for request in observed.graph.requests}
    assert services == {"get_state", "get_parameters"}


async def test_its_nodes_are_hidden_and_not_those_of_the_service(observed: Observed) -> None:
    await observed.begin()

    assert observed.graph.nodes
    assert all(name.startswith("_pilothouse_monitor_") for name in observed.graph.nodes)


async def test_a_name_that_ros_does_not_allow_is_told_and_left_out(
    caplog: pytest.LogCaptureFixture,
) -> None:
    odd, lamp = PartName("my-arm"), PartName("lamp")
    observed = Observed(SmhModel({odd: NodeModel(odd, {}), lamp: NodeModel(lamp, {})}, {}))
    observed.node(lamp, S.INACTIVE)
    with caplog.at_level(logging.WARNING):
        await observed.begin()
    await observed.clock.advance(1.5)
    await observed.end()

    assert "ROS does not allow the name: my-arm" in caplog.text
    assert observed.actual(lamp) == StateAndMode(S.INACTIVE)
    assert not observed.observer.parts.view(odd).reachable


async def test_a_graph_that_fails_ends_it(observed: Observed) -> None:
    await observed.begin()
    observed.graph.fail()
    assert observed.running is not None
    await asyncio.wait([observed.running])

    failure = observed.running.exception()
    assert isinstance(failure, ExceptionGroup)
    assert isinstance(failure.exceptions[0], GraphFailedError)
    assert observed.graph.closed


async def test_a_missing_type_is_told_and_the_graph_is_left() -> None:
    observed = Observed(None, "lifecycle_msgs/srv/GetState")
    with pytest.raises(UnknownTypeError):
        await observed.observer.run(lambda: None)

    assert observed.graph.closed


async def test_at_its_end_nothing_goes_on(observed: Observed) -> None:
    observed.base()
    await observed.begin()
    await observed.clock.advance(1.0)
    await observed.end()
    asked = len(observed.graph.requests)
    observed.clock.stall(5.0)
    await settle()

    assert observed.graph.closed
    assert len(observed.graph.requests) == asked
