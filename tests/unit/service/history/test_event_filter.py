import re
from datetime import timedelta

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.actor import Actor
from domain.events.changes import ChangeRequested
from domain.events.event import Event, RecordedEvent
from domain.events.kinds import EVENTS
from domain.state_and_mode import PartName
from service.history.event_filter import EventFilter, KindPattern, named_parts
from service.storage.journal import EventQuery
from tests.support.frames import Happened
from tests.support.manual_clock import START, ManualClock


def recorded(event: Event, at: int = 0) -> RecordedEvent:
    return RecordedEvent(5, at, None, Actor(way="http", address="10.0.0.7"), event)


@pytest.mark.parametrize(
    ("text", "kind", "expected"),
    [
        ("change.failed", "change.failed", True),
        ("change", "change.failed", True),
        ("chang", "change.failed", False),
        ("change.", "change.failed", False),
        ("chang*", "change.failed", True),
        ("*.failed", "change.failed", True),
        ("*.failed", "change.failed_twice", False),
        ("*", "change.failed", True),
        ("c*e*d", "change.failed", True),
        ("*change*", "change.failed", True),
        ("change.failed*failed", "change.failed", False),
        ("*.*.*", "change.failed", False),
        ("", "change.failed", False),
        ("**", "change.failed", True),
    ],
)
def test_a_pattern_means_these_kinds(text: str, kind: str, *, expected: bool) -> None:
    assert KindPattern(text).matches(kind) is expected


@given(
    text=st.text("ab.*", max_size=8).filter(lambda text: "*" in text),
    kind=st.text("ab.", max_size=10),
)
def test_stars_stand_for_any_characters(text: str, kind: str) -> None:
    plain = re.compile(".*".join(re.escape(piece) for piece in text.split("*")))

    assert KindPattern(text).matches(kind) == bool(plain.fullmatch(kind))


def test_a_hostile_pattern_is_decided_at_once() -> None:
    assert not KindPattern("*a" * 49 + "*b").matches("a" * 100)


def test_an_event_names_the_part_or_the_node_that_it_is_about() -> None:
    assert named_parts(ChangeRequested(PartName("arm"), mode="FAST")) == ("arm",)
    assert named_parts(Happened(1)) == ()


@pytest.mark.parametrize("kind", EVENTS.values())
def test_every_field_that_names_a_part_is_found(kind: type[Event]) -> None:
    """Such a field is called `part` or `node`."""
    names = {"part", "node"} & set(kind.data_keys())
    values = {name: PartName(name) if name in names else None for name in kind.data_keys()}
    event = object.__new__(kind)
    for name, value in values.items():
        object.__setattr__(event, name, value)

    assert set(named_parts(event)) == names


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


def test_nobody_is_an_actor_too() -> None:
    by_itself = RecordedEvent(1, 0, None, Actor(), Happened(1))

    assert EventFilter(EventQuery(actor=""), ManualClock()).accepts(by_itself)
