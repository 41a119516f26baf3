from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from api.client.service_client import (
    NoAnswerError,
    Outcome,
    ServiceClient,
    ServiceProblemError,
    change,
    refusal_lines,
    service_at,
    show_plan,
)
from api.http.access import FILE_VARIABLE, TOKEN_VARIABLE

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
        return ServiceClient(URL, httpx.MockTransport(self._answer))

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
    outcome = change(
        service.client(), "actuation", "mode", MODE, wait_s, said.append, pause=lambda _: None
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


def test_a_node_is_found_where_there_is_no_system_of_that_name(service: Service) -> None:
    assert service.client().path_of("drive_base") == "/nodes/drive_base"


def test_a_name_with_slashes_keeps_them_and_nothing_else_gets_into_the_path(
    service: Service,
) -> None:
    service.answers["GET /systems/left/arm%3Fx%20%23"] = httpx.Response(200, json={})

    assert service.client().path_of("left/arm?x #") == "/systems/left/arm%3Fx%20%23"


def test_a_part_that_does_not_exist_is_told_as_the_service_tells_it(service: Service) -> None:
    service.answers["GET /nodes/drive_base"] = problem(404, "UNKNOWN_PART")

    with pytest.raises(ServiceProblemError, match="it is so"):
        service.client().path_of("drive_base")


def test_another_problem_than_an_unknown_name_is_not_mistaken_for_one(service: Service) -> None:
    service.answers["GET /systems/actuation"] = problem(403, "FORBIDDEN_HOST")

    with pytest.raises(ServiceProblemError) as refused:
        service.client().path_of("actuation")

    assert refused.value.problem["code"] == "FORBIDDEN_HOST"


def test_a_dry_run_says_the_steps_and_changes_nothing(service: Service) -> None:
    steps = [step("arm", "configure", "pending"), step("arm", "set_parameters", "pending")]
    asked = "POST /systems/actuation/mode?dry_run=true"
    service.answers[asked] = httpx.Response(200, json={"part": "actuation", "steps": steps})
    said: list[str] = []

    outcome = show_plan(service.client(), "actuation", "mode", MODE, said.append)

    assert outcome is Outcome.SUCCEEDED
    assert said == ["would configure arm", "would set parameters arm"]
    assert [a for a in service.asked if a.startswith("POST")] == [asked]


def test_a_dry_run_without_steps_says_that_all_is_well(service: Service) -> None:
    answer = httpx.Response(200, json={"part": "actuation", "steps": []})
    service.answers["POST /systems/actuation/mode?dry_run=true"] = answer
    said: list[str] = []

    show_plan(service.client(), "actuation", "mode", MODE, said.append)

    assert said == ["actuation is there already: no step is needed"]


def test_a_refusal_is_told_with_what_stands_against_it_and_what_helps() -> None:
    blocker = {"code": "ESTOP", "message": "e-stop is pressed", "path": ["actuation", "estop"]}
    refused = {"detail": "actuation cannot be changed", "blockers": [blocker], "hint": "release it"}

    assert list(refusal_lines(refused)) == [
        "refused: actuation cannot be changed",
        "  ESTOP: e-stop is pressed (actuation > estop)",
        "  hint: release it",
    ]


def test_a_single_fault_of_a_body_is_told_once() -> None:
    fault = {"pointer": "/mode", "message": "there is no mode 'WARP'"}
    refused = {"detail": "/mode: there is no mode 'WARP'", "errors": [fault]}

    assert list(refusal_lines(refused)) == ["refused: /mode: there is no mode 'WARP'"]


def test_faults_of_a_body_are_told_with_their_place() -> None:
    faults = [{"pointer": "/mode", "message": "too long"}, {"pointer": "", "message": "no object"}]

    assert list(refusal_lines({"title": "Invalid", "errors": faults})) == [
        "refused: Invalid",
        "  /mode: too long",
        "  body: no object",
    ]


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (httpx.ConnectError("refused"), "no service answers at http://robot:8000"),
        (httpx.ReadTimeout("slow"), "no answer from http://robot:8000"),
        (httpx.Response(502, text="<html>Bad Gateway</html>"), "is not Pilothouse"),
        (httpx.Response(200, json=["a", "list"]), "is not Pilothouse"),
    ],
    ids=["nobody listens", "no answer in time", "a proxy answers", "something else answers"],
)
def test_no_answer_is_told_in_words(service: Service, answer: Answer, message: str) -> None:
    service.answers["GET /systems/actuation"] = answer

    with pytest.raises(NoAnswerError, match=message):
        service.client().path_of("actuation")


def test_a_csv_is_sent_as_it_is_with_its_query() -> None:
    asked: list[httpx.Request] = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request)
        return httpx.Response(201, json={"id": "t1"})

    client = ServiceClient(URL, httpx.MockTransport(answer))

    assert client.call("POST", "/tasks", csv="0,0,0\n", query={"speed_mps": 1.5}) == {"id": "t1"}
    assert asked[0].content == b"0,0,0\n"
    assert asked[0].headers["content-type"] == "text/csv"
    assert asked[0].url.raw_path == b"/tasks?speed_mps=1.5"


def test_an_answer_without_content_is_empty(service: Service) -> None:
    service.answers["DELETE /tasks/current"] = httpx.Response(204)

    assert service.client().call("DELETE", "/tasks/current") == {}


@pytest.mark.parametrize(
    "url", ["robot:8000", "ftp://robot", "http://", "http://[::1", "http://robot:0", "", "/ws"]
)
def test_what_is_no_address_is_refused_before_anything_is_sent(url: str) -> None:
    with pytest.raises(NoAnswerError, match="is no address"), service_at(url):
        pass


# --- with a token -------------------------------------------------------------------------------


def asked_with(token: str | None) -> httpx.Request:
    asked: list[httpx.Request] = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request)
        return httpx.Response(200, json={})

    ServiceClient(URL, httpx.MockTransport(answer), token).call("GET", "/systems")
    return asked[0]


def test_the_token_goes_with_each_request_and_nowhere_else() -> None:
    asked = asked_with("correct-horse-battery")

    assert asked.headers["authorization"] == "Bearer correct-horse-battery"
    assert "correct-horse-battery" not in str(asked.url)
    assert "authorization" not in asked_with(None).headers


@pytest.mark.parametrize(
    ("token", "hint"),
    [(None, f"set {TOKEN_VARIABLE} to the token"), ("wrong", "is that of another service")],
)
def test_who_has_no_or_another_token_is_told_what_to_do(token: str | None, hint: str) -> None:
    refused = problem(401, "UNAUTHORIZED", hint="send the header `Authorization: Bearer TOKEN`")
    client = ServiceClient(URL, httpx.MockTransport(lambda _: refused), token)

    with pytest.raises(ServiceProblemError) as caught:
        client.path_of("actuation")

    lines = list(refusal_lines(caught.value.problem))
    assert lines[0] == "refused: it is so"
    assert hint in lines[-1]
    assert FILE_VARIABLE in lines[-1]


def test_the_token_of_the_environment_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, "two words")

    with pytest.raises(NoAnswerError, match=TOKEN_VARIABLE), service_at(URL):
        pass

    monkeypatch.setenv(TOKEN_VARIABLE, "correct-horse-battery")
    with service_at(URL) as client:
        assert client.url == URL
