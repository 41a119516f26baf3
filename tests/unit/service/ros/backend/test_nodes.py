import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.commands import AskTransition
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState, Transition
from domain.parts.system_model import NodeModel
from domain.state_and_mode import DEFAULT_MODE, PartName
from service.ros.backend.nodes import RosNodes
from service.ros.graph.graph import Lane, Qos, UnknownTypeError
from tests.support.heard_nodes import HeardNodes, heard_nodes
from tests.support.manual_clock import ManualClock
from tests.support.models import ARM, BASE, actuation_model
from tests.support.ros_graph import LATENCY_S, FakeGraph
from tests.support.ros_nodes import FakeNode, parameter_event

S, T = LifecycleState, Transition
MANY = 50


@pytest.fixture
async def robot() -> AsyncIterator[HeardNodes]:
    async with heard_nodes() as heard:
        yield heard


async def many_nodes() -> HeardNodes:
    """Return a robot of fifty nodes that are all there."""
    models = [NodeModel(PartName(f"n{i}"), {DEFAULT_MODE: {"rate": 5}}) for i in range(MANY)]
    robot = HeardNodes(models)
    for model in models:
        FakeNode(robot.graph, model.name, {"rate": 5})
    await robot.join()
    return robot


async def test_it_listens_to_each_node_and_to_all_parameters(robot: HeardNodes) -> None:
    await robot.listen()

    assert robot.graph.nodes == {
        "pilothouse_states": Lane.STATES,
        "pilothouse_transitions": Lane.TRANSITIONS,
        "pilothouse_parameters": Lane.PARAMETERS,
        "pilothouse_liveliness": Lane.LIVELINESS,
    }
    assert robot.graph.qos == {
        "/drive_base/transition_event": Qos.EVENTS,
        "/manipulator/transition_event": Qos.EVENTS,
        "/parameter_events": Qos.PARAMETER_EVENTS,
    }
    assert robot.graph.types["/manipulator/heartbeat"] == "std_msgs/msg/Empty"


async def test_fifty_nodes_are_asked_how_they_are_in_one_burst() -> None:
    robot = await many_nodes()
    asked_before = len(robot.graph.requests)
    await robot.advance(1.0)
    await robot.end()

    asked = robot.graph.requests[asked_before:]
    assert len(asked) == MANY
    assert {request.at_s for request in asked} == {2.0}


async def test_fifty_transitions_go_out_at_once_while_all_are_asked_how_they_are() -> None:
    robot = await many_nodes()
    await robot.advance(0.5 + LATENCY_S / 2)
    asked_before = len(robot.graph.requests)
    for number in range(MANY):
        robot.ask(number, T.CONFIGURE, PartName(f"n{number}"))
    await robot.advance(0.0)
    sent = robot.graph.requests[asked_before:]
    await robot.advance(0.5)
    await robot.end()

    assert len(sent) == MANY
    assert all(request.service.endswith("/change_state") for request in sent)
    assert all(robot.states(PartName(f"n{i}"))[-1] is S.INACTIVE for i in range(MANY))


async def test_after_a_pause_all_goes_on_as_before(robot: HeardNodes) -> None:
    robot.base()
    await robot.join()
    robot.clock.stall(10.0)
    since_s = robot.now_s
    await robot.advance(3.0)

    assert len(robot.requests("get_state", since_s)) in (3, 4)
    assert robot.reports() == []


async def test_one_node_does_not_speak_for_another(robot: HeardNodes) -> None:
    base = robot.base()
    FakeNode(robot.graph, ARM, {"max_torque": 0.0})
    await robot.join()
    base.move(T.CONFIGURE)
    base.set({"max_speed": 0.5})
    await robot.advance(1.0)

    assert robot.states() == [S.CONFIGURING, S.INACTIVE, None]
    assert robot.reports(ARM) == []


async def test_parameters_of_strangers_and_of_nothing_are_not_heard(robot: HeardNodes) -> None:
    robot.base()
    await robot.join()
    robot.graph.publish("/parameter_events", parameter_event("somebody", {"rate": 5}))
    robot.graph.publish("/parameter_events", parameter_event(BASE, {}))
    await robot.advance(0.1)

    assert robot.heard == []


async def test_a_new_parameter_is_heard_as_a_changed_one_is(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    base.set({"max_speed": 0.5, "rate": 5})
    await robot.advance(0.1)

    assert robot.reports() == [NodeReport(BASE, parameters={"max_speed": 0.5, "rate": 5})]


async def test_a_node_in_a_namespace_is_heard_by_its_full_name() -> None:
    arm = NodeModel(PartName("left/arm"), {DEFAULT_MODE: {"rate": 5}})
    robot = HeardNodes([arm])
    node = FakeNode(robot.graph, arm.name, {"rate": 5})
    await robot.join()
    node.set({"rate": 20})
    robot.ask(1, T.CONFIGURE, arm.name)
    await robot.advance(0.1)
    await robot.end()

    assert robot.answers() == [NodeAnswer(1, arm.name, True)]
    assert NodeReport(arm.name, parameters={"rate": 20}) in robot.reports(arm.name)


async def test_a_command_for_a_node_that_is_not_in_the_model_is_refused(
    robot: HeardNodes,
) -> None:
    await robot.join()
    robot.ask(1, T.CONFIGURE, PartName("nowhere"))

    assert robot.answers() == [NodeAnswer(1, PartName("nowhere"), False, "there is no such node")]


async def test_before_and_after_its_run_nothing_is_sent(robot: HeardNodes) -> None:
    robot.base()
    robot.ask(1, T.CONFIGURE)
    await robot.join()
    await robot.end()
    asked = len(robot.graph.requests)
    robot.ask(2, T.CONFIGURE)
    robot.ask(3, T.CONFIGURE, PartName("nowhere"))

    assert robot.answers() == []
    assert len(robot.graph.requests) == asked


async def test_it_ends_with_all_that_it_began(robot: HeardNodes) -> None:
    base = robot.base()
    await robot.join()
    base.stop()
    robot.ask(1, T.CONFIGURE)
    await robot.advance(1.0)

    await robot.end()

    assert asyncio.all_tasks() == {asyncio.current_task()}


async def test_a_type_that_is_not_installed_is_told_at_the_start() -> None:
    clock = ManualClock()
    graph = FakeGraph(clock, missing=("lifecycle_msgs/msg/TransitionEvent",))
    nodes = RosNodes(actuation_model().nodes, graph, clock)

    with pytest.raises(UnknownTypeError):
        await nodes.start(lambda message: None)


async def test_what_is_heard_after_the_end_begins_nothing() -> None:
    clock = ManualClock()
    graph = FakeGraph(clock)
    nodes = RosNodes(actuation_model().nodes, graph, clock)
    base = FakeNode(graph, BASE, {"max_speed": 0.0, "controller": "none"})
    heard: list[object] = []
    await nodes.start(heard.append)
    running = asyncio.create_task(nodes.run())
    await clock.advance(0.5)
    running.cancel()
    await asyncio.wait([running])
    base.loses_events = True
    base.move(T.CONFIGURE)
    base.loses_events = False
    base.move(T.ACTIVATE)
    heard.clear()
    nodes.send(AskTransition(1, BASE, T.DEACTIVATE))
    await clock.advance(5.0)
    await graph.close()

    assert heard == []
