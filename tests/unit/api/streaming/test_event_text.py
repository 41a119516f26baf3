import json
import math

from api.streaming.event_text import event_text
from domain.events.driving import TaskStarted
from domain.events.event import RecordedEvent
from domain.events.parts import NodeReported
from domain.identifiers import GoalId, TaskId
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.manual_clock import ManualClock


def test_an_event_tells_what_happened_when_and_why() -> None:
    started = TaskStarted(TaskId("t1"), GoalId(1), 0)
    event = RecordedEvent(3, seconds(1.5), 2, "http:1", started)

    assert json.loads(event_text(event, "e1", ManualClock())) == {
        "type": "event",
        "epoch": "e1",
        "id": 3,
        "at": "2026-01-01T00:00:01.500Z",
        "kind": "task.started",
        "cause": 2,
        "actor": "http:1",
        "data": {"task": "t1", "goal": 1, "target_index": 0},
        "words": "task t1 started",
        "notable": True,
    }


def test_what_json_does_not_know_is_shown_as_near_as_can_be() -> None:
    reported = NodeReported(PartName("arm"), parameters={"torque": math.nan, "gains": (1.0, 2.0)})

    shown = json.loads(event_text(RecordedEvent(1, 0, None, "", reported), "e", ManualClock()))

    assert shown["data"] == {"node": "arm", "parameters": {"torque": None, "gains": [1.0, 2.0]}}
