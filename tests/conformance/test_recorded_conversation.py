"""A computer of this release understands one of an earlier release, which says what it then said.

`tests/data/link/v1` has what a supervisor and a device said to each other over the link. Here one
of the two is of this release, and the other says the same again, at the same times.
"""

import pytest

from domain.commands import TellStops
from domain.computers import SUPERVISOR, DeviceState, Incarnation, PeerStop
from domain.inputs import (
    DeviceStatus,
    Input,
    NodeAnswer,
    NodeReport,
    OrderReceived,
    PeerStops,
    SupervisorStatus,
)
from domain.lifecycle import LifecycleState
from domain.link.device_link import DeviceLink
from domain.link.messages import Beat, NodeOrder
from domain.link.supervisor_link import SupervisorLink
from tests.support.linked_pair import BASE, DRIVE, OWNED, TERMS
from tests.support.recorded_conversation import Line, ids_of, read


@pytest.fixture
def lines() -> list[Line]:
    return list(read())


def heard_by(machine: SupervisorLink | DeviceLink, lines: list[Line]) -> list[Input]:
    """Let a computer hear what is for it, and command what its core did then.

    Returns:
        What its core is given.
    """
    own = SUPERVISOR if isinstance(machine, SupervisorLink) else BASE
    given: list[Input] = []
    stops: tuple[str, ...] = ()
    for at, sender, _, message in lines:
        while machine.wake_at() <= at:
            given += machine.pass_time(machine.wake_at()).inputs
        if sender != own:
            given += machine.hear(sender, message, at).inputs
        elif isinstance(message, NodeOrder):
            given += machine.tell(message.command, at).inputs
        elif isinstance(message, Beat) and stops != (now := tuple(s.id for s in message.stops)):
            stops = now
            told = tuple(PeerStop(each.id, each.by, each.reason, at) for each in message.stops)
            given += machine.tell(TellStops(told), at).inputs
    return given


def test_a_supervisor_of_this_release_deals_with_a_device_of_an_earlier_one(
    lines: list[Line],
) -> None:
    (incarnation,) = ids_of(SUPERVISOR, lines)[:1]
    machine = SupervisorLink(TERMS, {BASE: OWNED[BASE]}, Incarnation(incarnation), 0)

    given = heard_by(machine, lines)

    states = [each.state for each in given if isinstance(each, DeviceStatus)]
    assert states == [DeviceState.CONNECTED]
    reports = [each.state for each in given if isinstance(each, NodeReport) and each.node == DRIVE]
    assert reports == [LifecycleState.UNCONFIGURED, LifecycleState.INACTIVE]
    assert [each.accepted for each in given if isinstance(each, NodeAnswer)] == [True]
    stops = [[stop.id for stop in each.stops] for each in given if isinstance(each, PeerStops)]
    assert ["b1"] in stops
    assert stops[-1] == []


def test_a_device_of_this_release_follows_a_supervisor_of_an_earlier_one(
    lines: list[Line],
) -> None:
    incarnation, *sessions = ids_of(BASE, lines)
    own, new_id = Incarnation(incarnation), iter(sessions)
    machine = DeviceLink(BASE, TERMS, (BASE,), OWNED[BASE], own, lambda: next(new_id), 0)

    given = heard_by(machine, lines)

    states = [each.state for each in given if isinstance(each, SupervisorStatus)]
    assert states == [DeviceState.CONNECTED]
    assert [each.command.node for each in given if isinstance(each, OrderReceived)] == [DRIVE]
    stops = [[stop.id for stop in each.stops] for each in given if isinstance(each, PeerStops)]
    assert stops[-1] == ["s1"]


def test_the_conversation_is_a_whole_one(lines: list[Line]) -> None:
    kinds = {type(line.message).__name__ for line in lines}
    assert kinds == {"Beat", "Report", "NodeOrder"}
