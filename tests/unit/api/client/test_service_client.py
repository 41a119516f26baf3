import subprocess
import sys

import httpx
import pytest

from api.access_token import FILE_VARIABLE, TOKEN_VARIABLE
from api.client.address import Address
from api.client.outcomes import NoAnswerError, ServiceProblemError, refusal_lines
from api.client.service_client import ServiceClient, service_at

URL = "http://robot:8000"
Answer = httpx.Response | Exception


class Service:
    """Answers what a test tells it to, and keeps what it was asked."""

    def __init__(self) -> None:
        self.asked: list[str] = []
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


def test_a_node_is_found_where_there_is_no_system_of_that_name(service: Service) -> None:
    assert service.client().path_of("drive_base") == "/nodes/drive_base"


def test_a_name_with_slashes_keeps_them_and_nothing_else_gets_into_the_path(
    service: Service,
) -> None:
    service.answers["GET /systems/left/arm%3Fx%20%23"] = httpx.Response(200, json={})

    assert service.client().path_of("left/arm?x #") == "/systems/left/arm%3Fx%20%23"


def test_a_part_that_does_not_exist_is_said_of_both_kinds(service: Service) -> None:
    for kind, names in (("systems", ["actuation"]), ("nodes", ["drive_base", "manipulator"])):
        items = [{"name": name} for name in names]
        service.answers[f"GET /{kind}/drivebase"] = problem(404, "UNKNOWN_PART")
        service.answers[f"GET /{kind}"] = httpx.Response(200, json={"items": items})

    with pytest.raises(ServiceProblemError, match="no system or node 'drivebase'") as unknown:
        service.client().path_of("drivebase")

    assert unknown.value.problem["hint"] == (
        "systems: actuation; nodes: drive_base, manipulator; did you mean drive_base?"
    )


@pytest.mark.parametrize("name", ["/drive_base", "drive_base"])
def test_a_leading_slash_of_a_name_is_left_out(service: Service, name: str) -> None:
    assert service.client().path_of(name) == "/nodes/drive_base"


def test_another_problem_than_an_unknown_name_is_not_mistaken_for_one(service: Service) -> None:
    service.answers["GET /systems/actuation"] = problem(403, "FORBIDDEN_HOST")

    with pytest.raises(ServiceProblemError) as refused:
        service.client().path_of("actuation")

    assert refused.value.problem["code"] == "FORBIDDEN_HOST"


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

    client = ServiceClient(Address.of(URL), httpx.MockTransport(answer))

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
    with pytest.raises(NoAnswerError, match="invalid address"), service_at(url):
        pass


# --- with a token -------------------------------------------------------------------------------


def asked_with(token: str | None) -> httpx.Request:
    asked: list[httpx.Request] = []

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request)
        return httpx.Response(200, json={})

    ServiceClient(Address.of(URL, token), httpx.MockTransport(answer)).call("GET", "/systems")
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
    client = ServiceClient(Address.of(URL, token), httpx.MockTransport(lambda _: refused))

    with pytest.raises(ServiceProblemError) as caught:
        client.path_of("actuation")

    lines = list(refusal_lines(caught.value.problem))
    assert lines[0] == "rejected: it is so"
    assert hint in lines[-1]
    assert FILE_VARIABLE in lines[-1]


def test_the_token_of_the_environment_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(TOKEN_VARIABLE, "two words")

    with pytest.raises(NoAnswerError, match=TOKEN_VARIABLE), service_at(URL):
        pass

    monkeypatch.setenv(TOKEN_VARIABLE, "correct-horse-battery")
    with service_at(URL) as client:
        assert client.address.url == URL


def test_a_command_starts_quickly_since_a_client_needs_nothing_of_the_service() -> None:
    code = "import sys, api.cli.commands.change, api.client.service_client; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()

    assert "httpx" in loaded
    heavy = {"api.http", "domain", "fastapi", "numpy", "pydantic", "starlette", "uvicorn"}
    assert heavy.isdisjoint(loaded)


def test_what_a_restart_would_forget_is_told_with_its_reason(service: Service) -> None:
    full = {"degraded": True, "reason": "the disk is full"}
    service.answers["GET /storage"] = httpx.Response(200, json=full)
    forgotten = httpx.Response(202, json={}, headers={"Pilothouse-Durable": "false"})
    service.answers["POST /nodes/drive_base/mode"] = forgotten
    client = service.client()
    client.call("GET", "/nodes/drive_base")
    assert client.why_forgotten() == ""

    client.call("POST", "/nodes/drive_base/mode", {"mode": "FAST"})
    assert client.why_forgotten() == "the disk is full"


def test_a_service_that_was_told_to_store_nothing_forgets_without_a_word(service: Service) -> None:
    service.answers["GET /storage"] = httpx.Response(200, json={"reason": None})
    forgotten = httpx.Response(202, json={}, headers={"Pilothouse-Durable": "false"})
    service.answers["POST /nodes/drive_base/mode"] = forgotten
    client = service.client()

    client.call("POST", "/nodes/drive_base/mode", {"mode": "FAST"})

    assert client.why_forgotten() == ""
