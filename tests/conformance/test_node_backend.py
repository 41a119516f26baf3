"""What every backend must keep, whatever its nodes are.

An adapter joins with a `BackendUnderTest` of its own in `UNDER_TEST`; the assertions are the same
for all. Nothing here knows how long a node takes: the tests wait for what should come, each in its
own kind of time.
"""

import asyncio
from collections.abc import AsyncIterator, Callable
from importlib import import_module
from typing import Protocol, TypeAlias

import pytest

from domain.commands import AskFacts, AskParameters, AskTransition
from domain.computers import SUPERVISOR, ComputerName
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters, ParameterValue
from domain.simulation.node_settings import Fault
from domain.simulation.robot import SimulatedRobot
from domain.state_and_mode import PartName
from service.clock import Clock, MonotonicClock
from service.files.robot_file import RobotSettings
from service.link.making import make_end
from service.link.memory import MemoryNetwork
from service.link.place import place_in
from service.link.port import Link
from service.ports import BackendMessage, NodeBackend
from service.ros.backend.backend import Ros2Backend
from service.simulation.simulated import SimulatedBackend
from tests.ros2.support.isolation import isolate
from tests.ros2.support.nodes_process import NodesProcess
from tests.support.linked_robot import Running, make_computer, names_of, settings_of
from tests.support.manual_clock import ManualClock
from tests.support.models import ARM, BASE, actuation_model
from tests.support.offset_clock import OffsetClock
from tests.support.robot_of_computers import free_port
from tests.support.ros_graph import FakeGraph
from tests.support.ros_nodes import FakeNode

S = LifecycleState
NOTICED_WITHIN_S = 5.0
"""How long a backend may take to notice that nothing is heard of a node."""


class BackendUnderTest(Protocol):
    """A backend over the nodes of `actuation_model`, which can be made to fall silent and die."""

    backend: NodeBackend

    async def pass_time(self, by_s: float) -> None:
        """Let at least this much time pass for the nodes and the backend."""

    def silence(self, node: PartName) -> None:
        """Let a node hear and act, but say nothing."""

    def kill(self, node: PartName) -> None:
        """End the process of a node."""

    def recover(self, node: PartName) -> None:
        """Let a node speak again, or start it again if its process ended."""

    async def end(self) -> None:
        """End what the nodes run in."""


class Simulated:
    """The simulated nodes, in virtual time."""

    def __init__(self) -> None:
        self._clock = ManualClock()
        robot = SimulatedRobot(actuation_model(), self._clock.now())
        self._simulated = SimulatedBackend(robot, self._clock)
        self.backend: NodeBackend = self._simulated

    async def pass_time(self, by_s: float) -> None:
        await self._clock.advance(by_s)

    def silence(self, node: PartName) -> None:
        self._simulated.set_fault(node, Fault.SILENT)

    def kill(self, node: PartName) -> None:
        self._simulated.set_fault(node, Fault.DIE)

    def recover(self, node: PartName) -> None:
        self._simulated.set_fault(node, None)

    async def end(self) -> None:
        pass


class InMemory:
    """Nodes of ROS 2 in a graph in memory, in virtual time."""

    def __init__(self) -> None:
        self._clock = ManualClock()
        graph = FakeGraph(self._clock)
        base: Parameters = {"max_speed": 0.0, "controller": "none"}
        arm: Parameters = {"max_torque": 0.0}
        self._nodes = {BASE: FakeNode(graph, BASE, base), ARM: FakeNode(graph, ARM, arm)}
        self._stopped: set[PartName] = set()
        self.backend: NodeBackend = Ros2Backend(
            actuation_model(), RobotSettings(), graph, self._clock
        )

    async def pass_time(self, by_s: float) -> None:
        await self._clock.advance(by_s)

    def silence(self, node: PartName) -> None:
        self._stopped.add(node)
        self._nodes[node].stop()

    def kill(self, node: PartName) -> None:
        self._nodes[node].kill()

    def recover(self, node: PartName) -> None:
        if node in self._stopped:
            self._nodes[node].go_on()
        else:
            self._nodes[node].start()

    async def end(self) -> None:
        pass


class RealNodes:
    """Nodes of rclpy, each in a process of its own, in real time."""

    def __init__(self) -> None:
        isolate()
        base = {"max_speed": 0.0, "controller": "none"}
        self._processes = {
            BASE: NodesProcess({"name": BASE, "parameters": base}),
            ARM: NodesProcess({"name": ARM, "parameters": {"max_torque": 0.0}}),
        }
        for process in self._processes.values():
            process.start()
        self._stopped: set[PartName] = set()
        link = import_module("service.ros.graph.link").RosLink()
        self.backend: NodeBackend = Ros2Backend(
            actuation_model(), RobotSettings(), link, MonotonicClock()
        )

    async def pass_time(self, by_s: float) -> None:
        await asyncio.sleep(by_s)

    def silence(self, node: PartName) -> None:
        self._stopped.add(node)
        self._processes[node].silence()

    def kill(self, node: PartName) -> None:
        self._processes[node].kill()

    def recover(self, node: PartName) -> None:
        if node in self._stopped:
            self._processes[node].go_on()
        else:
            self._processes[node].start()

    async def end(self) -> None:
        for process in self._processes.values():
            process.kill()


class OnDevices:
    """Simulated nodes on two other computers, whose clocks are wrong.

    Args:
        clock: Of the supervisor.
        link: Returns the link of a computer by its name.
    """

    def __init__(self, clock: Clock, link: Callable[[ComputerName], Link]) -> None:
        self._devices = Running()
        model, robot = actuation_model(), settings_of(SUPERVISOR)
        place = place_in(robot)
        assert place is not None
        self.backend: NodeBackend = make_end(place, model, robot, link(SUPERVISOR), clock)
        self._nodes: dict[PartName, SimulatedBackend] = {}
        for name, node, ahead_s in (("base", BASE, 300.0), ("arm", ARM, -300.0)):
            own = OffsetClock(clock, ahead_s)
            made = make_computer(model, settings_of(name), link(ComputerName(name)), own)
            device, self._nodes[node] = made
            self._devices.start(name, device)

    def silence(self, node: PartName) -> None:
        self._nodes[node].set_fault(node, Fault.SILENT)

    def kill(self, node: PartName) -> None:
        self._nodes[node].set_fault(node, Fault.DIE)

    def recover(self, node: PartName) -> None:
        self._nodes[node].set_fault(node, None)

    async def end(self) -> None:
        await self._devices.stop()


class Remote(OnDevices):
    """Nodes on other computers in a network in memory, in virtual time."""

    def __init__(self) -> None:
        self._clock = ManualClock()
        super().__init__(self._clock, MemoryNetwork(names_of(), self._clock).link)

    async def pass_time(self, by_s: float) -> None:
        await self._clock.advance(by_s)


class OverZenoh(OnDevices):
    """Nodes on other computers over zenoh, in real time."""

    def __init__(self) -> None:
        made = pytest.importorskip("service.link.zenoh_link", reason="there is no zenoh")
        robot = {"connect": [f"tcp/127.0.0.1:{free_port()}"]}

        def link(name: ComputerName) -> Link:
            place = place_in(settings_of(name, link=robot))
            assert place is not None
            over: Link = made.ZenohLink(place.name, place.others, place.endpoints)
            return over

        super().__init__(MonotonicClock(), link)

    async def pass_time(self, by_s: float) -> None:
        await asyncio.sleep(by_s)


UNDER_TEST: list[object] = [
    Simulated,
    InMemory,
    Remote,
    # Each test takes some seconds.
    pytest.param(OverZenoh, marks=pytest.mark.soak),
    pytest.param(RealNodes, marks=pytest.mark.ros2),
]


class Robot:
    """A running backend, and everything that it delivered."""

    def __init__(self, under_test: BackendUnderTest) -> None:
        self.under_test = under_test
        self.heard: list[BackendMessage] = []
        self.running = asyncio.create_task(
            under_test.backend.run(self.heard.append), name="backend under test"
        )

    def send_transition(self, request: int, node: PartName, transition: Transition) -> None:
        self.under_test.backend.send(AskTransition(request, node, transition))

    async def until(self, is_it: Callable[[], bool], within_s: float = 10.0) -> None:
        """Let time pass until something is the case."""
        waited_s = 0.0
        while not is_it():
            if self.running.done():
                self.running.result()
            assert waited_s < within_s, f"did not come in {within_s} s; heard: {self.heard[-5:]}"
            await self.under_test.pass_time(_STEP_S)
            waited_s += _STEP_S

    async def until_in(self, node: PartName, state: LifecycleState, within_s: float = 10.0) -> None:
        """Let time pass until a node has reported a state."""
        await self.until(lambda: self.states(node)[-1:] == [state], within_s)

    async def until_missed(self, node: PartName) -> None:
        """Let time pass until a node is reported as unreachable, and no longer than it may take."""
        await self.until(lambda: self.reachability(node)[-1:] == [False], NOTICED_WITHIN_S)

    async def forget(self) -> None:
        """Forget what was heard, once nothing more comes."""
        await self.under_test.pass_time(2.0)
        self.heard.clear()

    async def bring(self, node: PartName, *transitions: Transition) -> None:
        """Lead a node through transitions, then forget about it."""
        for request, transition in enumerate(transitions, start=1_000):
            self.send_transition(request, node, transition)
            await self.until_in(node, transition.goal)
        await self.forget()

    def reports(self, node: PartName) -> list[NodeReport]:
        return [m for m in self.heard if isinstance(m, NodeReport) and m.node == node]

    def states(self, node: PartName) -> list[LifecycleState]:
        """Return the states that were reported, each once where it was reported again."""
        found: list[LifecycleState] = []
        for report in self.reports(node):
            if report.state is not None and found[-1:] != [report.state]:
                found.append(report.state)
        return found

    def parameters(self, node: PartName) -> dict[str, object]:
        """Return the parameters that were reported, the newest of each name."""
        found: dict[str, object] = {}
        for report in self.reports(node):
            found |= report.parameters or {}
        return found

    def reachability(self, node: PartName) -> list[bool]:
        return [r.reachable for r in self.reports(node) if r.reachable is not None]

    def answer(self, request: int) -> NodeAnswer | None:
        found = [m for m in self.heard if isinstance(m, NodeAnswer) and m.request == request]
        assert len(found) <= 1, "a request is answered once"
        return found[0] if found else None


_STEP_S = 0.05


@pytest.fixture(params=UNDER_TEST, ids=lambda made: made.__name__.lower())
async def under_test(request: pytest.FixtureRequest) -> AsyncIterator[BackendUnderTest]:
    made: BackendUnderTest = request.param()
    yield made
    await made.end()


@pytest.fixture
async def robot(under_test: BackendUnderTest) -> AsyncIterator[Robot]:
    robot = Robot(under_test)
    try:
        # Real nodes have to be found first.
        await robot.until(lambda: knows_all(robot, BASE) and knows_all(robot, ARM))
        yield robot
    finally:
        robot.running.cancel()
        await asyncio.wait([robot.running])


Loss: TypeAlias = Callable[[BackendUnderTest, PartName], None]
LOSSES: list[object] = [
    pytest.param(lambda under_test, node: under_test.silence(node), id="silent"),
    pytest.param(lambda under_test, node: under_test.kill(node), id="dead"),
]


def knows_all(robot: Robot, node: PartName) -> bool:
    """Tell whether a node said that it is there, what it is in and what it has set."""
    return bool(
        robot.reachability(node)[-1:] == [True] and robot.states(node) and robot.parameters(node)
    )


async def test_all_nodes_are_there_at_once_with_all_that_they_are_in(robot: Robot) -> None:
    await robot.until(lambda: knows_all(robot, BASE) and knows_all(robot, ARM))

    for node, names in {BASE: {"max_speed", "controller"}, ARM: {"max_torque"}}.items():
        assert robot.states(node) == [S.UNCONFIGURED]
        assert robot.parameters(node).keys() >= names
        assert True in {report.has_lifecycle for report in robot.reports(node)}


async def test_a_transition_is_accepted_and_reported_on_its_way_and_at_its_end(
    robot: Robot,
) -> None:
    await robot.forget()
    robot.send_transition(1, BASE, Transition.CONFIGURE)
    await robot.until_in(BASE, S.INACTIVE)

    answer = robot.answer(1)
    assert answer is not None
    assert answer.accepted
    assert robot.states(BASE) == [S.CONFIGURING, S.INACTIVE]
    assert robot.states(ARM) == []


async def test_a_node_is_led_through_its_whole_life(robot: Robot) -> None:
    await robot.forget()
    life = {
        Transition.CONFIGURE: S.INACTIVE,
        Transition.ACTIVATE: S.ACTIVE,
        Transition.DEACTIVATE: S.INACTIVE,
        Transition.CLEANUP: S.UNCONFIGURED,
        Transition.SHUTDOWN: S.FINALIZED,
    }
    for request, (transition, goal) in enumerate(life.items()):
        robot.send_transition(request, BASE, transition)
        await robot.until_in(BASE, goal)

    assert robot.states(BASE) == [
        *(S.CONFIGURING, S.INACTIVE, S.ACTIVATING, S.ACTIVE, S.DEACTIVATING, S.INACTIVE),
        *(S.CLEANING_UP, S.UNCONFIGURED, S.SHUTTING_DOWN, S.FINALIZED),
    ]


async def test_a_transition_that_is_not_to_be_had_is_refused_with_a_reason(robot: Robot) -> None:
    await robot.forget()
    robot.send_transition(1, BASE, Transition.DEACTIVATE)
    await robot.until(lambda: robot.answer(1) is not None)
    await robot.under_test.pass_time(1.0)

    answer = robot.answer(1)
    assert answer is not None
    assert not answer.accepted
    assert answer.reason
    assert robot.states(BASE) in ([], [S.UNCONFIGURED])


async def test_parameters_are_accepted_and_reported(robot: Robot) -> None:
    await robot.forget()
    values: dict[str, ParameterValue] = {"max_speed": 0.9, "controller": "MPC"}
    robot.under_test.backend.send(AskParameters(1, BASE, values))
    await robot.until(lambda: robot.parameters(BASE) == values and robot.answer(1) is not None)

    answer = robot.answer(1)
    assert answer is not None
    assert answer.accepted


@pytest.mark.parametrize("wrong", [{"controller": 7}, {"no_such_parameter": 0.1}])
async def test_of_parameters_of_which_one_is_wrong_none_is_set(
    robot: Robot, wrong: dict[str, int | float]
) -> None:
    await robot.forget()
    robot.under_test.backend.send(AskParameters(1, BASE, {"max_speed": 0.77, **wrong}))
    await robot.until(lambda: robot.answer(1) is not None)
    robot.under_test.backend.send(AskFacts(2, BASE))
    await robot.until(lambda: "max_speed" in robot.parameters(BASE))

    answer = robot.answer(1)
    assert answer is not None
    assert not answer.accepted
    assert answer.reason
    assert robot.parameters(BASE)["max_speed"] != 0.77


async def test_a_node_that_is_asked_says_what_it_is_in_and_what_it_has_set(robot: Robot) -> None:
    await robot.bring(BASE, Transition.CONFIGURE)
    robot.under_test.backend.send(AskFacts(1, BASE))
    await robot.until(lambda: knows_all(robot, BASE))

    assert robot.states(BASE) == [S.INACTIVE]
    assert robot.parameters(BASE).keys() >= {"max_speed", "controller"}
    assert robot.reports(ARM) == []


@pytest.mark.parametrize("lose", LOSSES)
async def test_a_node_of_which_nothing_is_heard_is_reported_in_time(
    robot: Robot, lose: Loss
) -> None:
    await robot.forget()
    lose(robot.under_test, BASE)
    await robot.until_missed(BASE)

    assert robot.reachability(ARM) in ([], [True])


@pytest.mark.parametrize("lose", LOSSES)
async def test_a_node_that_is_lost_answers_nothing_that_it_does_not_know(
    robot: Robot, lose: Loss
) -> None:
    await robot.forget()
    lose(robot.under_test, BASE)
    robot.send_transition(1, BASE, Transition.CONFIGURE)
    await robot.until_missed(BASE)
    robot.send_transition(2, BASE, Transition.CONFIGURE)
    await robot.under_test.pass_time(1.0)

    for answer in (robot.answer(1), robot.answer(2)):
        assert answer is None or (not answer.accepted and answer.reason)


async def test_a_silent_node_that_is_back_says_what_it_has_done_meanwhile(robot: Robot) -> None:
    await robot.forget()
    robot.under_test.silence(BASE)
    robot.send_transition(1, BASE, Transition.CONFIGURE)
    await robot.until_missed(BASE)
    robot.heard.clear()
    robot.under_test.recover(BASE)
    await robot.until(lambda: knows_all(robot, BASE))

    assert robot.states(BASE)[-1] is S.INACTIVE


async def test_a_dead_node_that_is_back_is_unconfigured(robot: Robot) -> None:
    await robot.bring(BASE, Transition.CONFIGURE, Transition.ACTIVATE)
    robot.under_test.kill(BASE)
    await robot.until_missed(BASE)
    robot.heard.clear()
    robot.under_test.recover(BASE)
    await robot.until(lambda: knows_all(robot, BASE))

    assert robot.states(BASE) == [S.UNCONFIGURED]


async def test_a_node_that_is_back_can_be_asked_again(robot: Robot) -> None:
    await robot.forget()
    robot.under_test.kill(BASE)
    await robot.until_missed(BASE)
    robot.under_test.recover(BASE)
    await robot.until(lambda: robot.reachability(BASE) == [False, True])
    robot.send_transition(1, BASE, Transition.CONFIGURE)

    await robot.until_in(BASE, S.INACTIVE)


async def test_a_lost_node_does_not_hold_up_another(robot: Robot) -> None:
    await robot.forget()
    robot.under_test.kill(BASE)
    robot.send_transition(1, BASE, Transition.CONFIGURE)
    robot.send_transition(2, ARM, Transition.CONFIGURE)

    await robot.until_in(ARM, S.INACTIVE, within_s=2.0)


async def test_a_command_for_a_node_that_is_not_there_does_no_harm(robot: Robot) -> None:
    nowhere = PartName("nowhere")
    await robot.forget()
    robot.send_transition(1, nowhere, Transition.CONFIGURE)
    robot.under_test.backend.send(AskParameters(2, nowhere, {"x": 1}))
    robot.under_test.backend.send(AskFacts(3, nowhere))
    robot.send_transition(4, BASE, Transition.CONFIGURE)
    await robot.until_in(BASE, S.INACTIVE)

    for answer in (robot.answer(1), robot.answer(2), robot.answer(3)):
        assert answer is None or (not answer.accepted and answer.reason)
    assert robot.reports(nowhere) == []


async def test_it_runs_until_it_is_cancelled_and_leaves_no_task(robot: Robot) -> None:
    before = asyncio.all_tasks()
    await robot.forget()
    robot.send_transition(1, BASE, Transition.CONFIGURE)
    await robot.under_test.pass_time(0.1)
    assert not robot.running.done()

    robot.running.cancel()
    await asyncio.wait([robot.running])

    assert robot.running.cancelled()
    # What nodes run in may have tasks of its own.
    await robot.under_test.end()
    assert asyncio.all_tasks() <= before - {robot.running}


async def test_what_the_listener_raises_ends_the_run(under_test: BackendUnderTest) -> None:
    def fail(message: BackendMessage) -> None:
        raise LookupError

    with pytest.raises(LookupError):
        await under_test.backend.run(fail)
