from collections.abc import Mapping

import pytest

from domain.lifecycle import LifecycleState
from domain.parts.observed_parts import AnnouncedTarget
from service.ros.backend.announced_targets import AnnouncedTargets
from service.ros.graph.graph import Lane, Qos, UnknownTypeError
from service.ros.interface.fallback_types import TOPIC_FALLBACKS
from service.ros.interface.message_fields import mode_event, transition_event
from tests.support.manual_clock import ManualClock
from tests.support.models import ACTUATION, BASE, FAST, PERFORMANCE
from tests.support.ros_graph import FakeGraph

S = LifecycleState
MODE_EVENT = "system_modes_msgs/msg/ModeEvent"
MODES, TRANSITIONS = "/actuation/mode_request_info", "/actuation/transition_request_info"


async def listening(graph: FakeGraph) -> list[AnnouncedTarget]:
    """Return what is heard from now on."""
    heard: list[AnnouncedTarget] = []
    node = graph.node("listener", Lane.TARGETS)
    await AnnouncedTargets((ACTUATION, BASE), graph, node).start(heard.append)
    return heard


def make_graph(*missing: str) -> FakeGraph:
    return FakeGraph(ManualClock(), missing)


def latch(graph: FakeGraph, topic: str, message: Mapping[str, object]) -> None:
    graph.node("manager", Lane.GATEWAY).publisher(topic, "", Qos.LATCHED).publish(message)


async def test_a_requested_transition_is_a_target_without_a_mode() -> None:
    graph = make_graph()
    heard = await listening(graph)
    graph.publish(TRANSITIONS, transition_event(7, None, S.ACTIVE, S.INACTIVE))

    assert set(heard) == {AnnouncedTarget(ACTUATION, S.INACTIVE, None, 7)}


async def test_a_requested_mode_is_a_target_in_it() -> None:
    graph = make_graph()
    heard = await listening(graph)
    graph.publish("/drive_base/mode_request_info", mode_event(8, None, FAST))

    assert set(heard) == {AnnouncedTarget(BASE, S.ACTIVE, FAST, 8)}


async def test_who_comes_late_gets_what_was_latched_and_everything_later() -> None:
    graph = make_graph()
    latch(graph, MODES, mode_event(1, None, FAST))
    heard = await listening(graph)

    assert heard == [AnnouncedTarget(ACTUATION, S.ACTIVE, FAST, 1)]

    graph.publish(MODES, mode_event(2, FAST, PERFORMANCE))

    assert heard[-1] == AnnouncedTarget(ACTUATION, S.ACTIVE, PERFORMANCE, 2)


async def test_without_the_messages_of_modes_a_mode_is_read_from_a_state() -> None:
    graph = make_graph(MODE_EVENT)
    heard = await listening(graph)
    carried = TOPIC_FALLBACKS[MODE_EVENT].message(mode_event(3, None, PERFORMANCE))
    graph.publish(MODES, carried)

    assert set(heard) == {AnnouncedTarget(ACTUATION, S.ACTIVE, PERFORMANCE, 3)}


@pytest.mark.parametrize("missing", [(), (MODE_EVENT,)])
async def test_what_names_no_target_is_not_heard(missing: tuple[str, ...]) -> None:
    graph = make_graph(*missing)
    heard = await listening(graph)
    nothing = mode_event(3, FAST, None)
    graph.publish(MODES, TOPIC_FALLBACKS[MODE_EVENT].message(nothing) if missing else nothing)
    graph.publish(TRANSITIONS, transition_event(3, None, S.ACTIVE, S.UNKNOWN))

    assert heard == []


async def test_a_label_that_is_no_state_is_not_heard() -> None:
    graph = make_graph(MODE_EVENT)
    heard = await listening(graph)
    graph.publish(MODES, {"timestamp": 1, "goal_state": {"id": 3, "label": "flying.FAST"}})

    assert heard == []


async def test_without_the_messages_of_lifecycles_it_is_told_at_once() -> None:
    with pytest.raises(UnknownTypeError):
        await listening(make_graph("lifecycle_msgs/msg/TransitionEvent"))
