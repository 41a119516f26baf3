"""The stop at the command line."""

import json
from typing import Any

import pytest

from api.cli import stop_delivery
from api.cli.command_line import main
from api.client import bare_request
from api.client.bare_request import Answer
from api.client.outcomes import NoAnswerError, NoConnectionError

Output = pytest.CaptureFixture[str]

LATCH = {
    "engaged": True,
    "reason": "dog on the track",
    "standstill_at": "2026-05-04T12:00:01.000Z",
}
VEHICLE = {"at": "2026-05-04T12:00:01.000Z", "speed_mps": 0.0}


class Robot:
    """A service that is asked for a stop, or a place where there is none."""

    def __init__(self) -> None:
        self.answer: Answer | Exception = Answer(200, LATCH, is_volatile=False)
        self.storage: dict[str, Any] = {"reason": None}
        self.stops: list[tuple[str, Any]] = []

    def ask(self, address: Any, method: str, path: str, _: float, body: Any = None) -> Answer:  # noqa: ANN401
        if method == "PUT":
            self.stops.append((address.url, body))
            if isinstance(self.answer, Exception):
                raise self.answer
            return self.answer
        bodies = {"/emergency_stop": LATCH, "/vehicle": VEHICLE, "/storage": self.storage}
        return Answer(200, bodies[path], is_volatile=False)


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Robot:
    robot = Robot()
    monkeypatch.setattr(bare_request, "bare_request", robot.ask)
    monkeypatch.delenv("PILOTHOUSE_URL", raising=False)
    return robot


def test_all_words_are_the_reason(robot: Robot, capsys: Output) -> None:
    assert main(["stop", "dog", "on", "the", "track"]) == 0

    assert robot.stops == [
        ("http://127.0.0.1:8000", {"engaged": True, "reason": "dog on the track"})
    ]
    engaged, still = capsys.readouterr().out.splitlines()
    assert engaged.startswith("stop engaged 0.")
    assert still == "the vehicle stands still"


@pytest.mark.parametrize(
    "words",
    [
        ["--resaon", "dog"],
        ["dog", "--url", "http://robot", "on", "the", "track"],
        ["--retry", "soon", "--wait", "-1", "dog"],
        ["--wait", "nan"],
        ["dog", "--retry"],
        ["--format", "xml"],
        ["--url"],
        ["x" * 10_000],
    ],
)
def test_no_mistake_on_the_command_line_keeps_the_vehicle_from_being_stopped(
    robot: Robot, words: list[str]
) -> None:
    assert main(["stop", *words]) == 0

    (stopped,) = robot.stops
    assert stopped[0] == ("http://robot" if "http://robot" in words else "http://127.0.0.1:8000")
    assert len(stopped[1]["reason"]) <= 500


def test_the_address_comes_from_the_environment(
    robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PILOTHOUSE_URL", "http://robot:9000")

    assert main(["stop"]) == 0
    assert robot.stops[0][0] == "http://robot:9000"


def test_programs_get_one_object(robot: Robot, capsys: Output) -> None:
    assert main(["stop", "--format", "json"]) == 0

    told = json.loads(capsys.readouterr().out)
    assert (told["delivered"], told["tries"], told["standstill"]) == (True, 1, True)
    assert told["emergency_stop"] == LATCH
    assert robot.stops


def test_without_a_service_the_hardware_stop_is_named(robot: Robot, capsys: Output) -> None:
    robot.answer = NoConnectionError("no service answers at http://robot: is it running?")

    assert main(["stop", "--retry", "0"]) == 2

    out, err = capsys.readouterr()
    assert out == ""
    assert err.splitlines() == [
        "pilothouse: try 1: no service answers at http://robot: is it running?",
        "pilothouse: Not delivered. Use the hardware stop.",
    ]


def test_a_stop_without_an_answer_may_have_arrived(robot: Robot, capsys: Output) -> None:
    robot.answer = NoAnswerError("no answer from http://robot: timed out")

    assert main(["stop", "--retry", "0", "--format", "json"]) == 2

    out, err = capsys.readouterr()
    assert json.loads(out)["delivered"] is None
    assert "It is not known whether the stop was delivered. Use the hardware stop." in err


def test_a_rejected_token_is_told_with_what_to_do(robot: Robot, capsys: Output) -> None:
    body = {"detail": "a token is needed", "hint": "send the header `Authorization`"}
    robot.answer = Answer(401, body, is_volatile=False)

    assert main(["stop", "--format", "json"]) == 1

    out, err = capsys.readouterr()
    assert json.loads(out)["delivered"] is False
    assert "rejected: a token is needed" in err
    assert "PILOTHOUSE_TOKEN" in err
    assert "Not delivered. Use the hardware stop." in err


def test_an_invalid_address_is_told_with_what_to_do(robot: Robot, capsys: Output) -> None:
    assert main(["stop", "--url", "robot"]) == 2

    assert "Not delivered. Use the hardware stop." in capsys.readouterr().err
    assert not robot.stops


def test_what_a_restart_would_forget_is_told(robot: Robot, capsys: Output) -> None:
    robot.answer = Answer(200, LATCH, is_volatile=True)
    robot.storage = {"reason": "the disk is full"}

    assert main(["stop"]) == 0
    assert "would forget this: the disk is full" in capsys.readouterr().err


def test_computers_that_may_go_on_are_named(robot: Robot, capsys: Output) -> None:
    robot.answer = Answer(200, {**LATCH, "not_heard": ["arm", "base"]}, is_volatile=False)

    assert main(["stop"]) == 0
    told = "arm, base: not heard, and not known to be stopped. Use the hardware stop there."
    assert told in capsys.readouterr().err


def test_ctrl_c_between_tries_leaves_it_open_whether_it_was_delivered(
    robot: Robot, monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(stop_delivery, "deliver", interrupt)

    assert main(["stop"]) == 130
    assert "It is not known whether the stop was delivered" in capsys.readouterr().err
    assert not robot.stops


def test_ctrl_c_while_it_brakes_leaves_the_stop_engaged(
    robot: Robot, monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("api.cli.standstill.Standstill.wait", interrupt)

    assert main(["stop"]) == 130
    assert "the stop stays engaged" in capsys.readouterr().err
    assert robot.stops
