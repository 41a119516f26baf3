"""What an operator reads who asks why."""

import json
from typing import Any

import httpx
import pytest

from api.cli.command_line import main
from api.cli.commands.why import reason_lines, why, why_not, why_robot
from api.client.address import Address
from api.client.outcomes import Outcome, ServiceProblemError
from api.client.service_client import ServiceClient
from tests.support.asked_service import AskedService


def _blocker(code: str, message: str, *path: str, **more: object) -> dict[str, Any]:
    return {
        "code": code,
        "message": message,
        "path": list(path),
        "refuses": True,
        "causes": [],
        **more,
    }


DEAD = _blocker("UNREACHABLE", "manipulator is unreachable", "actuation", "manipulator")
LOW = _blocker("CONDITION", "battery_level is 0.21, needs >= 0.3", "actuation", "battery_level")
HERE = {
    "actual": {"state": "active", "mode": "PERFORMANCE"},
    "target": {"state": "active", "mode": "PERFORMANCE"},
    "effective_target": {"state": "active", "mode": "PERFORMANCE", "because": "requested"},
    "converged": True,
    "blockers": [],
}
MODES = [
    {"mode": "MODERATE", "can_enter": True, "blockers": [], "requires": [], "invariants": []},
    {
        "mode": "PERFORMANCE",
        "can_enter": False,
        "blockers": [LOW],
        "requires": ["battery_level >= 0.3"],
        "invariants": ["temperature < 50"],
    },
]


def _client(found: dict[str, Any]) -> ServiceClient:
    answers = {
        "/systems/actuation": {"name": "actuation"},
        "/systems/actuation/why": found,
        "/systems/actuation/modes": {"items": MODES},
    }

    def answer(request: httpx.Request) -> httpx.Response:
        return httpx.Response(200, json=answers[request.url.path])

    return ServiceClient(Address.of("http://robot:8000"), httpx.MockTransport(answer))


def test_a_part_that_is_where_it_should_be_says_so() -> None:
    said: list[str] = []
    assert why(_client(HERE), "actuation", "text", said.append) is Outcome.SUCCEEDED
    assert said == ["actuation is active.PERFORMANCE, as its target says"]


def test_a_part_that_is_elsewhere_is_told_with_its_reasons() -> None:
    elsewhere = {
        **HERE,
        "actual": {"state": "activating", "mode": None},
        "converged": False,
        "blockers": [DEAD],
    }
    said: list[str] = []
    assert why(_client(elsewhere), "actuation", "text", said.append) is Outcome.FAILED
    assert said == [
        "actuation is activating, target active.PERFORMANCE",
        "  UNREACHABLE: manipulator is unreachable  (actuation > manipulator)",
    ]


def test_a_part_of_which_nothing_was_requested_is_where_it_should_be() -> None:
    said: list[str] = []
    nothing = {**HERE, "target": None, "effective_target": None}
    assert why(_client(nothing), "actuation", "text", said.append) is Outcome.SUCCEEDED
    assert said == ["actuation is active.PERFORMANCE; nothing was requested of it"]


def test_a_mode_that_cannot_be_entered_is_told_with_its_guards() -> None:
    said: list[str] = []
    ended = why_not(_client(HERE), "actuation", "PERFORMANCE", "text", said.append)
    assert ended is Outcome.FAILED
    assert said == [
        "actuation cannot enter PERFORMANCE now",
        "  CONDITION: battery_level is 0.21, needs >= 0.3  (actuation > battery_level)",
        "  requires: battery_level >= 0.3",
        "  invariants: temperature < 50",
    ]


def test_a_mode_that_can_be_entered_ends_with_success() -> None:
    said: list[str] = []
    ended = why_not(_client(HERE), "actuation", "MODERATE", "text", said.append)
    assert ended is Outcome.SUCCEEDED
    assert said == ["actuation can enter MODERATE now"]


def test_an_unknown_mode_is_answered_with_those_that_there_are() -> None:
    said: list[str] = []
    with pytest.raises(ServiceProblemError, match="no mode of actuation 'PERFORMANC'") as unknown:
        why_not(_client(HERE), "actuation", "PERFORMANC", "text", said.append)
    assert unknown.value.problem["hint"] == (
        "known: MODERATE, PERFORMANCE; did you mean PERFORMANCE?"
    )


class Robot:
    """What keeps a robot from driving."""

    def __init__(self, **more: object) -> None:
        self.answers = {
            "/system_state": {"state": "RUNNING", "task_status": "NO_TASK", "reasons": []},
            "/holds": {"items": []},
            "/emergency_stop": {"engaged": False},
            **more,
        }

    def why(self, how: str = "text") -> tuple[Outcome, list[str]]:
        service = AskedService({f"GET {path}": body for path, body in self.answers.items()})
        said: list[str] = []
        return why_robot(service.client(), how, said.append), said


LUNCH = {"owner": "operator", "reason": "lunch", "since_at": "2026-05-04T12:00:00.000Z"}


def test_a_robot_that_nothing_keeps_from_driving() -> None:
    said = ["the robot is RUNNING, no task; nothing keeps it"]
    assert Robot().why() == (Outcome.SUCCEEDED, said)


def test_errors_stop_and_holds_keep_a_robot_from_driving() -> None:
    state = {"state": "ERROR", "task_status": "PAUSED_TASK", "reasons": [LOW]}
    stop = {"engaged": True, "by": "http:10.0.0.7", "reason": "dog"}
    robot = Robot(**{"/system_state": state, "/holds": {"items": [LUNCH]}, "/emergency_stop": stop})

    outcome, said = robot.why()

    assert outcome is Outcome.FAILED
    assert said == [
        "the robot is ERROR, paused task",
        "  emergency stop by http:10.0.0.7: dog",
        "  CONDITION: battery_level is 0.21, needs >= 0.3  (actuation > battery_level)",
        "  held by operator: lunch  [since 2026-05-04T12:00:00.000Z]",
    ]


def test_a_stop_on_another_computer_says_where_it_is() -> None:
    stops = [{"id": "arm-1", "device": "arm"}]
    stop = {"engaged": True, "by": "ada", "reason": "dog", "stops": stops, "not_heard": ["arm"]}

    _, said = Robot(**{"/emergency_stop": stop}).why()

    assert said[1] == "  emergency stop at device arm (not heard) by ada: dog"


def test_what_keeps_a_robot_is_written_as_json() -> None:
    _, (told,) = Robot().why("json")

    assert set(json.loads(told)) == {"system_state", "holds", "emergency_stop"}


def test_json_is_what_the_service_answers() -> None:
    said: list[str] = []
    why(_client(HERE), "actuation", "json", said.append)
    assert json.loads(said[0]) == HERE


def test_causes_stand_below_what_follows_from_them() -> None:
    tree = _blocker("INVARIANT", "robot cannot stay FAST", "robot", causes=[LOW], refuses=False)
    assert list(reason_lines([tree])) == [
        "  INVARIANT: robot cannot stay FAST  (robot)  [does not refuse]",
        "    CONDITION: battery_level is 0.21, needs >= 0.3",
    ]


def test_a_service_that_does_not_answer_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["why", "actuation", "--url", "http://127.0.0.1:9"]) == Outcome.UNKNOWN
    assert "127.0.0.1:9" in capsys.readouterr().err
