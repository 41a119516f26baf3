import json
import math

import pytest

from api.streaming.robot_encoder import LatestCache, MemberCache, RobotEncoder
from domain.actor import NOBODY, Actor
from domain.events.driving import TaskStarted
from domain.events.event import RecordedEvent
from domain.events.parts import NodeReported
from domain.events.service import TimeWasDue
from domain.identifiers import GoalId, TaskId
from domain.inputs import EmergencyStopRequest, HoldRequest
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor


class View:
    def __init__(self, text: str) -> None:
        self.text = text


@pytest.fixture
def supervisor() -> Supervisor:
    return make_supervisor()


@pytest.fixture
def encoder(supervisor: Supervisor) -> RobotEncoder:
    return RobotEncoder(supervisor)


def test_an_event_tells_what_happened_when_and_why_and_in_words(
    encoder: RobotEncoder, supervisor: Supervisor
) -> None:
    started = TaskStarted(TaskId("t1"), GoalId(1), 0)

    assert json.loads(
        encoder.event(RecordedEvent(3, seconds(1.5), 2, Actor("http:1"), started))
    ) == {
        "type": "event",
        "epoch": supervisor.epoch,
        "id": 3,
        "at": "2026-01-01T00:00:01.500Z",
        "kind": "task.started",
        "cause": 2,
        "actor": "http:1",
        "data": {"task": "t1", "goal": 1, "target_index": 0},
        "words": "task t1 started",
        "notable": True,
    }


def test_a_detail_has_words_too_and_is_not_notable(encoder: RobotEncoder) -> None:
    told = json.loads(encoder.event(RecordedEvent(1, 0, None, NOBODY, TimeWasDue())))

    assert told["words"]
    assert told["notable"] is False


def test_what_json_does_not_know_is_shown_as_near_as_can_be(encoder: RobotEncoder) -> None:
    reported = NodeReported(PartName("arm"), parameters={"torque": math.nan, "gains": (1.0, 2.0)})

    shown = json.loads(encoder.event(RecordedEvent(1, 0, None, NOBODY, reported)))

    assert shown["data"] == {"node": "arm", "parameters": {"torque": None, "gains": [1.0, 2.0]}}


def test_holds_are_a_map_by_owner_encoded_once_as_long_as_they_are_the_same(
    encoder: RobotEncoder, supervisor: Supervisor
) -> None:
    supervisor.submit(HoldRequest("gate", "closed", Actor("http:1")))
    driving = supervisor.core.driving

    text = encoder.holds(driving.holds)

    assert json.loads(text)["gate"] == {
        "owner": "gate",
        "reason": "closed",
        "by": "http:1",
        "since_at": "2026-01-01T00:00:00.000Z",
    }
    assert encoder.holds(driving.holds) is text
    supervisor.submit(HoldRequest("operator", "", Actor("http:1")))
    assert set(json.loads(encoder.holds(driving.holds))) >= {"gate", "operator"}


def test_the_emergency_stop_is_as_in_its_get(encoder: RobotEncoder, supervisor: Supervisor) -> None:
    supervisor.submit(EmergencyStopRequest(engaged=True, reason="smoke", actor=Actor("anna")))

    assert json.loads(encoder.emergency_stop(supervisor.core.emergency_stop())) == {
        "engaged": True,
        "by": "anna",
        "reason": "smoke",
        "since_at": "2026-01-01T00:00:00.000Z",
        "standstill_at": None,
        "stops": [
            {
                "id": "stop-1",
                "device": None,
                "by": "anna",
                "reason": "smoke",
                "since_at": "2026-01-01T00:00:00.000Z",
            }
        ],
        "waits_for": [],
        "not_heard": [],
    }


def test_no_task_is_null(encoder: RobotEncoder) -> None:
    assert encoder.task(None) == "null"


def test_members_are_joined_to_an_object_with_their_names_escaped() -> None:
    members = MemberCache[View](lambda view: view.text)

    assert members.text({"a": View("1"), 'b"': View("2")}) == '{"a":1,"b\\"":2}'


def test_members_of_a_frame_are_utf_8_without_braces() -> None:
    members = MemberCache[View](lambda view: view.text)

    assert members.members({"größe": View('"20 °C"'), "b": View("2")}) == (
        '"größe":"20 °C","b":2'.encode()
    )
    assert members.members({}) == b""


def test_a_view_that_is_the_same_is_not_made_again() -> None:
    made: list[View] = []

    def encode(view: View) -> str:
        made.append(view)
        return view.text

    members = MemberCache[View](encode)
    first, second = View("1"), View("2")
    members.text({"a": first, "b": second})
    assert members.text({"a": first, "b": View("3")}) == '{"a":1,"b":3}'

    assert [view.text for view in made] == ["1", "2", "3"]


def test_what_was_learned_before_is_not_new() -> None:
    members = MemberCache[View](lambda view: view.text)
    known, new = View("1"), View("2")
    members.learn([("a", known)])

    assert list(members.new_ones([("a", known), ("b", new)])) == [("b", new)]


def test_only_the_latest_view_is_kept() -> None:
    made: list[str] = []

    def encode(view: View) -> str:
        made.append(view.text)
        return view.text

    latest = LatestCache[View](encode)
    first, second = View("1"), View("2")

    assert [latest.text(view) for view in (first, first, second, first)] == ["1", "1", "2", "1"]
    assert made == ["1", "2", "1"]
