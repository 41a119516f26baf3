from datetime import timedelta

import pytest

from domain.actor import Actor
from domain.events.changes import ChangeRequested
from domain.events.event import Event, RecordedEvent
from domain.state_and_mode import PartName
from service.history.event_filter import EventFilter
from service.storage.journal import EventQuery
from tests.support.frames import Happened
from tests.support.manual_clock import START, ManualClock


def recorded(event: Event, at: int = 0) -> RecordedEvent:
    return RecordedEvent(5, at, None, Actor(way="http", address="10.0.0.7"), event)


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        (EventQuery(), True),
        (EventQuery(after=4, before=6), True),
        (EventQuery(after=5), False),
        (EventQuery(before=5), False),
        (EventQuery(from_at=START + timedelta(seconds=2)), True),
        (EventQuery(from_at=START + timedelta(seconds=3)), False),
        (EventQuery(to_at=START + timedelta(seconds=2, microseconds=1)), True),
        (EventQuery(to_at=START + timedelta(seconds=2)), False),
        (EventQuery(actor="http:10.0.0.7"), True),
        (EventQuery(actor="http"), False),
        (EventQuery(part=PartName("arm")), True),
        (EventQuery(part=PartName("ar")), False),
        (EventQuery(kind="node", part=PartName("arm")), False),
    ],
)
def test_all_that_is_asked_for_has_to_fit(query: EventQuery, *, expected: bool) -> None:
    event = recorded(ChangeRequested(PartName("arm"), mode="FAST"), at=2_000_001_500)

    assert EventFilter(query, ManualClock()).accepts(event) is expected


def test_nobody_is_an_actor_to_ask_for() -> None:
    by_itself = RecordedEvent(1, 0, None, Actor(), Happened(1))

    assert EventFilter(EventQuery(actor=""), ManualClock()).accepts(by_itself)
