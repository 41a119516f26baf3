import asyncio
from array import array
from collections.abc import AsyncIterator, Awaitable
from typing import Any, TypeVar

import numpy as np
import pytest

from domain.lifecycle import LifecycleState, Transition
from domain.parameters import ParameterValue, same_value
from service.ros.backend.node_services import (
    Askers,
    NodeServices,
    read_parameters,
    read_state,
    write_value,
)
from service.ros.graph.graph import Lane, UnknownTypeError
from tests.support.heard_nodes import START_PARAMETERS
from tests.support.manual_clock import ManualClock
from tests.support.models import BASE
from tests.support.ros_graph import FakeGraph, as_message
from tests.support.ros_nodes import FakeNode

S, T = LifecycleState, Transition
ResultT = TypeVar("ResultT")


@pytest.fixture
async def graph() -> AsyncIterator[FakeGraph]:
    made = FakeGraph(ManualClock())
    yield made
    await made.close()


@pytest.fixture
async def base(graph: FakeGraph) -> FakeNode:
    return FakeNode(graph, BASE, START_PARAMETERS)


def services_in(graph: FakeGraph) -> NodeServices:
    lanes = (Lane.STATES, Lane.TRANSITIONS, Lane.PARAMETERS)
    return NodeServices(BASE, Askers(*(graph.node(f"ours_{lane.value}", lane) for lane in lanes)))


@pytest.fixture
def services(graph: FakeGraph) -> NodeServices:
    return services_in(graph)


async def answered(graph: FakeGraph, question: Awaitable[ResultT]) -> ResultT:
    """Let time pass until a question is answered, or until it is too late for that."""
    asked = asyncio.ensure_future(question)
    await graph.clock.advance(100.0)
    return await asked


# --- questions -----------------------------------------------------------------------------------


async def test_a_node_says_what_it_is_in_and_what_it_has_set(
    graph: FakeGraph, base: FakeNode, services: NodeServices
) -> None:
    base.move(T.CONFIGURE)

    assert services.are_complete
    assert await answered(graph, services.state()) is S.INACTIVE
    assert await answered(graph, services.parameters(START_PARAMETERS)) == START_PARAMETERS


async def test_what_the_graph_knows_of_a_node_is_told_apart(
    graph: FakeGraph, services: NodeServices
) -> None:
    def known() -> tuple[bool, bool, bool]:
        return services.has_lifecycle, services.has_parameters, services.are_complete

    nobody = known()
    FakeNode(graph, BASE, START_PARAMETERS, plain=True)
    plain = known()
    FakeNode(graph, BASE, START_PARAMETERS)

    assert nobody == (False, False, False)
    assert plain == (False, True, False)
    assert known() == (True, True, True)


async def test_a_node_that_is_not_there_does_not_answer(
    graph: FakeGraph, services: NodeServices
) -> None:
    with pytest.raises(TimeoutError):
        await answered(graph, services.state())


async def test_parameters_that_are_not_declared_are_left_out(
    graph: FakeGraph, base: FakeNode, services: NodeServices
) -> None:
    asked = services.parameters(["wheels", "max_speed"])

    assert await answered(graph, asked) == {"max_speed": base.parameters["max_speed"]}


async def test_a_node_says_which_transitions_it_offers(
    graph: FakeGraph, base: FakeNode, services: NodeServices
) -> None:
    base.move(T.CONFIGURE)

    offered = await answered(graph, services.available_transitions())
    assert set(offered) == {"cleanup", "activate", "shutdown"}


# --- commands ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("transition", "start", "number"),
    [
        (T.CONFIGURE, S.UNCONFIGURED, 1),
        (T.SHUTDOWN, S.UNCONFIGURED, 5),
        (T.SHUTDOWN, S.INACTIVE, 6),
        (T.SHUTDOWN, S.ACTIVE, 7),
        (T.SHUTDOWN, None, 5),
        (T.ACTIVATE, S.UNCONFIGURED, 3),
    ],
)
async def test_a_transition_is_asked_for_by_label_and_number(
    graph: FakeGraph,
    services: NodeServices,
    transition: Transition,
    start: LifecycleState | None,
    number: int,
) -> None:
    with pytest.raises(TimeoutError):
        await answered(graph, services.change_state(transition, start))

    (request,) = graph.requests
    assert request.fields == {"transition": {"id": number, "label": str(transition)}}


async def test_a_transition_is_answered_when_it_was_done_or_refused(
    graph: FakeGraph, base: FakeNode, services: NodeServices
) -> None:
    assert await answered(graph, services.change_state(T.CONFIGURE, S.UNCONFIGURED))
    assert base.state is S.INACTIVE
    assert not await answered(graph, services.change_state(T.CONFIGURE, S.INACTIVE))


async def test_parameters_are_set_or_it_is_said_why_not(
    graph: FakeGraph, base: FakeNode, services: NodeServices
) -> None:
    done = await answered(graph, services.set_parameters({"max_speed": 0.5}, {}))
    refused = await answered(graph, services.set_parameters({"max_speed": 1}, {}))

    assert (done, refused) == ("", "max_speed is of type double, not integer")
    assert base.parameters["max_speed"] == 0.5


async def test_a_refusal_without_a_reason_gets_one(
    graph: FakeGraph, services: NodeServices
) -> None:
    async def refuse(_: object) -> dict[str, Any]:
        return {"result": {"successful": False, "reason": ""}}

    graph.offer(f"/{BASE}/set_parameters_atomically", refuse)

    assert await answered(graph, services.set_parameters({"max_speed": 0.5}, {})) != ""


def test_a_type_that_is_not_installed_is_told_at_once() -> None:
    graph = FakeGraph(ManualClock(), missing=("lifecycle_msgs/srv/GetState",))

    with pytest.raises(UnknownTypeError, match="lifecycle_msgs"):
        services_in(graph)


# --- values --------------------------------------------------------------------------------------


@pytest.mark.parametrize("state", list(S))
def test_a_state_is_read_by_its_number(state: LifecycleState) -> None:
    assert read_state(as_message({"id": state.id, "label": "in other words"})) is state


def test_a_state_that_nobody_knows_is_unknown() -> None:
    assert read_state(as_message({"id": 99, "label": "dreaming"})) is S.UNKNOWN


VALUES: list[tuple[ParameterValue, int]] = [
    (True, 1),
    (1, 2),
    (1.0, 3),
    ("PID", 4),
    ((True, False), 6),
    ((1, 2), 7),
    ((1.0, 2.5), 8),
    (("a", "b"), 9),
]


@pytest.mark.parametrize(("value", "number"), VALUES, ids=lambda it: repr(it))
def test_a_value_is_written_with_its_type_and_read_again(
    value: ParameterValue, number: int
) -> None:
    written = write_value(value)
    read = read_parameters([as_message({"name": "x", "value": written})])

    assert written["type"] == number
    assert same_value(read["x"], value)


@pytest.mark.parametrize(
    ("known", "number"), [((1, 2), 7), ((1.5,), 8), ((), 9), (None, 9), (5, 9)]
)
def test_an_empty_array_is_of_the_type_that_the_parameter_holds(
    known: ParameterValue | None, number: int
) -> None:
    assert write_value((), known)["type"] == number


@pytest.mark.parametrize(
    ("field", "number", "held", "value"),
    [
        ("integer_array_value", 7, array("q", [1, 2]), (1, 2)),
        ("double_array_value", 8, array("d", [1.0]), (1.0,)),
        ("double_array_value", 8, np.array([0.5, 1.0]), (0.5, 1.0)),
        ("double_value", 3, np.float64(0.5), 0.5),
    ],
)
def test_a_value_is_read_from_whatever_ros_holds_it_in(
    field: str, number: int, held: object, value: ParameterValue
) -> None:
    message = as_message({"name": "x", "value": {"type": number, field: held}})

    assert same_value(read_parameters([message])["x"], value)


@pytest.mark.parametrize("number", [0, 5, 10])
def test_what_is_not_set_or_cannot_be_in_a_mode_is_left_out(number: int) -> None:
    message = as_message({"name": "x", "value": {"type": number, "byte_array_value": [b"\x01"]}})

    assert read_parameters([message]) == {}
