import json
import math
from types import MappingProxyType

from api.streaming.event_text import event_text
from domain.events import Event
from domain.timebase import seconds
from tests.support.manual_clock import ManualClock


def test_an_event_tells_what_happened_when_and_why() -> None:
    event = Event(3, seconds(1.5), "task.started", 2, "http:1", {"task": "t1"})

    assert json.loads(event_text(event, "e1", ManualClock())) == {
        "type": "event",
        "epoch": "e1",
        "id": 3,
        "at": "2026-01-01T00:00:01.500Z",
        "kind": "task.started",
        "cause": 2,
        "actor": "http:1",
        "data": {"task": "t1"},
    }


def test_what_json_does_not_know_is_shown_as_near_as_can_be() -> None:
    data = {"nan": math.nan, "view": MappingProxyType({"a": 1})}
    event = Event(1, 0, "node.reported", None, "", data)

    assert json.loads(event_text(event, "e", ManualClock()))["data"] == {
        "nan": None,
        "view": {"a": 1},
    }
