import math
from itertools import chain
from types import MappingProxyType

import pytest

from domain.actor import Actor
from domain.events.changes import ChangeRequested
from domain.events.driving import HoldSet
from domain.events.event import Event, RecordedEvent
from domain.events.health import SignalRead
from domain.events.kinds import EVENTS
from domain.state_and_mode import PartName
from service.clock import since_epoch
from service.storage.event_rows import event_row, named_parts, stored_event
from tests.support.manual_clock import START
from tests.support.record_samples.events import EVENTS as SAMPLES

WALL_NS = since_epoch(START)


def test_an_event_is_read_back_as_clients_see_it() -> None:
    requested = ChangeRequested(PartName("left/arm"), mode="FAST")
    recorded = RecordedEvent(7, 50, 3, Actor("", "http", "10.0.0.7"), requested)

    row = event_row(recorded, WALL_NS)
    stored = stored_event(row, 2, "epoch")

    assert row.parts == ("left/arm",)
    assert (stored.id, stored.boot, stored.epoch, stored.at) == (7, 2, "epoch", 50)
    assert stored.wall_at.isoformat() == "2026-01-01T00:00:00+00:00"
    assert (stored.kind, stored.cause, stored.actor) == ("change.requested", 3, "http:10.0.0.7")
    assert stored.data == {"part": "left/arm", "mode": "FAST"}
    assert stored.words == "left/arm: FAST requested"


def test_an_event_that_names_no_part_is_of_none() -> None:
    row = event_row(RecordedEvent(1, 0, None, Actor(), HoldSet("left/arm", "")), WALL_NS)

    assert row.parts == ()


def test_every_kind_of_event_can_be_a_row() -> None:
    for event in chain.from_iterable(SAMPLES.values()):
        assert isinstance(event, Event)
        row = event_row(RecordedEvent(1, 0, None, Actor(), event), WALL_NS)
        assert stored_event(row, 1, "epoch").kind in EVENTS


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_number_that_json_does_not_have_is_null_as_in_the_stream(value: float) -> None:
    read = SignalRead("battery", {"battery_level": value})

    row = event_row(RecordedEvent(1, 0, None, Actor(), read), WALL_NS)

    assert '"battery_level":null' in row.data


def test_a_read_only_mapping_is_read_back_as_a_mapping() -> None:
    parameters = MappingProxyType({"gain": 2.0})
    requested = ChangeRequested(PartName("arm"), parameters=parameters)

    row = event_row(RecordedEvent(1, 0, None, Actor(), requested), WALL_NS)

    assert stored_event(row, 1, "epoch").data["parameters"] == {"gain": 2.0}


@pytest.mark.parametrize("kind", EVENTS.values())
def test_every_field_that_names_a_part_is_found(kind: type[Event]) -> None:
    """Such a field is called `part` or `node`."""
    names = {"part", "node"} & set(kind.data_keys())
    event = object.__new__(kind)
    for name in kind.data_keys():
        object.__setattr__(event, name, PartName(name) if name in names else None)

    assert set(named_parts(event)) == names
