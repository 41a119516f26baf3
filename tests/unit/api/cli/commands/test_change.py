from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from api.cli.change_report import TextReport
from api.cli.command_line import main
from api.cli.commands.change import change, show_plan
from api.client.address import Address
from api.client.outcomes import Outcome
from api.client.service_client import ServiceClient

URL = "http://robot:8000"
Answer = httpx.Response | Exception
MODE = {"mode": "PERFORMANCE"}


def step(node: str, action: str, status: str, error: str | None = None) -> dict[str, Any]:
    return {"node": node, "action": action, "status": status, "error": error}


def view(status: str, *steps: dict[str, Any], reason: str | None = None) -> dict[str, Any]:
    return {"id": "c1", "status": status, "reason": reason, "steps": list(steps)}


class Service:
    """Answers what a test tells it to, and keeps what it was asked."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.views: Iterator[dict[str, Any]] = iter(())
        self.answers: dict[str, Answer] = {
            "GET /systems/actuation": httpx.Response(200, json={"name": "actuation"}),
            "GET /systems/drive_base": problem(404, "UNKNOWN_PART"),
            "GET /nodes/drive_base": httpx.Response(200, json={"name": "drive_base"}),
        }

    def client(self) -> ServiceClient:
        return ServiceClient(Address.of(URL), httpx.MockTransport(self._answer))

    def _answer(self, request: httpx.Request) -> httpx.Response:
        asked = f"{request.method} {request.url.raw_path.decode()}"
        self.asked.append(asked)
        if asked.startswith(("POST", "GET /changes")) and asked not in self.answers:
            return httpx.Response(202, json=next(self.views))
        answer = self.answers[asked]
        if isinstance(answer, Exception):
            raise answer
        return answer


def problem(status: int, code: str, **more: object) -> httpx.Response:
    body = {"status": status, "code": code, "title": "Refused", "detail": "it is so", **more}
    return httpx.Response(status, json=body)


@pytest.fixture
def service() -> Service:
    return Service()


def run(service: Service, *views: dict[str, Any], wait_s: float = 60) -> tuple[Outcome, list[str]]:
    said: list[str] = []
    service.views = iter(views)
    report = TextReport(said.append)
    outcome = change(
        service.client(), "actuation", "mode", MODE, wait_s, report, pause=lambda _: None
    )
    return outcome, said


def test_a_change_is_followed_step_by_step_to_its_end(service: Service) -> None:
    outcome, said = run(
        service,
        view("running", step("arm", "configure", "running"), step("arm", "activate", "pending")),
        view("running", step("arm", "configure", "succeeded"), step("arm", "activate", "running")),
        view(
            "succeeded", step("arm", "configure", "succeeded"), step("arm", "activate", "succeeded")
        ),
    )

    assert outcome is Outcome.SUCCEEDED
    assert said == [
        "configure arm...",
        "configure arm: succeeded",
        "activate arm...",
        "activate arm: succeeded",
        "actuation: succeeded",
    ]
    assert service.asked[-1] == "GET /changes/c1"


def test_a_change_that_was_met_already_ends_at_once(service: Service) -> None:
    assert run(service, view("succeeded")) == (Outcome.SUCCEEDED, ["actuation: succeeded"])


def test_a_failure_is_told_with_the_step_and_the_reason(service: Service) -> None:
    failed = step("arm", "set_parameters", "failed", "max_torque is read-only")

    outcome, said = run(service, view("failed", failed, reason="arm refused"))

    assert outcome is Outcome.FAILED
    assert said == [
        "set parameters arm: failed: max_torque is read-only",
        "actuation: failed: arm refused",
    ]


@pytest.mark.parametrize(
    ("status", "outcome"),
    [
        ("failed", Outcome.FAILED),
        ("superseded", Outcome.FAILED),
        ("canceled", Outcome.FAILED),
        ("timed_out", Outcome.UNKNOWN),
    ],
)
def test_an_end_other_than_success_is_told_by_the_exit_code(
    service: Service, status: str, outcome: Outcome
) -> None:
    assert run(service, view(status))[0] is outcome


def test_a_change_that_takes_too_long_is_unknown_and_goes_on(service: Service) -> None:
    outcome, said = run(service, view("running"), wait_s=0)

    assert outcome is Outcome.UNKNOWN
    assert said == ["not ended within 0 s; see http://robot:8000/changes/c1"]


def test_the_second_step_of_the_same_kind_is_told_too(service: Service) -> None:
    _, said = run(
        service,
        view("succeeded", *[step("arm", "set_parameters", "succeeded") for _ in range(2)]),
    )

    assert said[:2] == ["set parameters arm: succeeded"] * 2


def _plan(
    steps: list[dict[str, Any]], stages: int = 1, expected_s: float | None = None
) -> dict[str, Any]:
    return {"part": "actuation", "steps": steps, "stages": stages, "expected_s": expected_s}


def test_a_dry_run_in_stages_says_them_and_how_long_it_takes(service: Service) -> None:
    steps = [
        {**step("arm", "activate", "pending"), "stage": 1},
        {**step("drive_base", "activate", "pending"), "stage": 0},
    ]
    answer = httpx.Response(200, json=_plan(steps, 2, 0.40000001))
    service.answers["POST /systems/actuation/mode?dry_run=true"] = answer
    said: list[str] = []

    show_plan(service.client(), "actuation", "mode", MODE, "text", said.append)

    assert said == [
        "stage 0: would activate drive_base",
        "stage 1: would activate arm",
        "takes about 0.4 s",
    ]


def test_a_request_that_waits_says_for_what_and_is_followed(service: Service) -> None:
    service.views = iter(
        [
            view("waiting", reason="battery_level is 0.2, needs >= 0.3"),
            view("running", step("drive_base", "activate", "running")),
            view("succeeded", step("drive_base", "activate", "succeeded")),
        ]
    )
    said: list[str] = []

    report = TextReport(said.append)
    outcome = change(service.client(), "actuation", "mode", MODE, 60, report, pause=lambda _: None)

    assert outcome is Outcome.SUCCEEDED
    assert said[0] == "waits: battery_level is 0.2, needs >= 0.3"
    assert said[-1] == "actuation: succeeded"


def test_a_dry_run_says_the_steps_and_changes_nothing(service: Service) -> None:
    actions = ("configure", "set_parameters")
    steps = [{**step("arm", action, "pending"), "stage": 0} for action in actions]
    asked = "POST /systems/actuation/mode?dry_run=true"
    service.answers[asked] = httpx.Response(200, json=_plan(steps))
    said: list[str] = []

    outcome = show_plan(service.client(), "actuation", "mode", MODE, "text", said.append)

    assert outcome is Outcome.SUCCEEDED
    assert said == ["would configure arm", "would set parameters arm"]
    assert [a for a in service.asked if a.startswith("POST")] == [asked]


def test_a_dry_run_without_steps_says_that_all_is_well(service: Service) -> None:
    answer = httpx.Response(200, json=_plan([]))
    service.answers["POST /systems/actuation/mode?dry_run=true"] = answer
    said: list[str] = []

    show_plan(service.client(), "actuation", "mode", MODE, "text", said.append)

    assert said == ["actuation is there already: no step is needed"]


# --- the command line ----------------------------------------------------------------------------


def test_mode_asks_for_the_mode_and_waits_as_long_as_it_was_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given: list[tuple[object, ...]] = []

    def change(_: ServiceClient, *asked: object) -> Outcome:
        given.append(asked[:-1])
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.cli.commands.change.change", change)

    assert main(["mode", "actuation", "FAST"]) == 0
    main(["mode", "actuation", "SLOW", "--wait", "1.5"])

    assert given == [
        ("actuation", "mode", {"mode": "FAST"}, 60.0),
        ("actuation", "mode", {"mode": "SLOW"}, 1.5),
    ]


def test_state_asks_for_the_transition(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[object, ...]] = []

    def change(_: ServiceClient, *asked: object) -> Outcome:
        given.append(asked[:-1])
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.cli.commands.change.change", change)

    assert main(["state", "drive_base", "deactivate"]) == 0

    assert given == [("drive_base", "state", {"transition": "deactivate"}, 60.0)]
