"""Who has no token gets at nothing of the robot."""

import json
from collections.abc import AsyncIterator

import pytest

from api.http.access import Access
from api.http.gate.refusals import Refusals
from api.http.gate.token import TokenGate
from tests.support.asgi import answer_200, messages_of, status_of, websocket_scope
from tests.support.http_robot import HttpRobot, declared_policies, http_robot, http_scope
from tests.support.manual_clock import ManualClock

TOKEN = "correct-horse-battery"
RIGHT = {"Authorization": f"Bearer {TOKEN}"}


@pytest.fixture
async def guarded() -> AsyncIterator[HttpRobot]:
    async with http_robot(access=Access.with_token(TOKEN)) as running:
        yield running


def gate(access: Access) -> TokenGate:
    return TokenGate(answer_200, access, declared_policies(), Refusals(ManualClock()))


async def test_a_service_without_a_token_asks_for_none(robot: HttpRobot) -> None:
    assert (await robot.http.get("/systems")).status_code == 200
    assert (await robot.http.get("/systems", headers=RIGHT)).status_code == 200


async def test_every_operation_of_the_contract_asks_for_the_token_but_the_probes(
    guarded: HttpRobot,
) -> None:
    open_to_all = set()
    for path, operations in guarded.app.openapi()["paths"].items():
        for method in operations:
            answer = await guarded.http.request(method, path.replace("{", "").replace("}", ""))
            if answer.status_code != 401:
                open_to_all.add((method, path))

    assert open_to_all == {("get", "/livez"), ("get", "/readyz")}


@pytest.mark.parametrize(
    "path", ["/nowhere", "/metrics", "/healthz", "/webx", "/livez/", "/docsx", "/docs/x"]
)
async def test_whatever_is_not_named_as_open_is_not(path: str, guarded: HttpRobot) -> None:
    assert (await guarded.http.get(path)).status_code == 401


@pytest.mark.parametrize(
    "path",
    ["/", "/web/style/base.css", "/web/js/main.js", "/web/icon.svg", "/openapi.json", "/livez"],
)
async def test_the_page_can_be_loaded_to_ask_for_the_token(path: str, guarded: HttpRobot) -> None:
    assert (await guarded.http.get(path)).status_code == 200


@pytest.mark.parametrize("path", ["/docs", "/docs/swagger-ui.css", "/asyncapi.json"])
async def test_documents_say_nothing_of_the_robot(path: str) -> None:
    assert await status_of(gate(Access.with_token(TOKEN)), http_scope("GET", path)) == 200


async def test_what_is_open_can_only_be_read(guarded: HttpRobot) -> None:
    assert (await guarded.http.post("/livez")).status_code == 401
    assert (await guarded.http.head("/livez")).status_code != 401


async def test_with_the_token_everything_is_as_without_one(guarded: HttpRobot) -> None:
    answer = await guarded.http.put(
        "/emergency_stop", json={"engaged": True, "reason": "test"}, headers=RIGHT
    )

    assert answer.status_code == 200
    assert guarded.supervisor.core.emergency_stop().engaged


async def test_without_it_nothing_is_changed(guarded: HttpRobot) -> None:
    answer = await guarded.http.put("/emergency_stop", json={"engaged": True, "reason": "test"})

    assert answer.status_code == 401
    assert not guarded.supervisor.core.emergency_stop().engaged


async def test_a_refusal_says_what_to_send(guarded: HttpRobot) -> None:
    answer = await guarded.http.get("/systems")

    problem = answer.json()
    assert answer.headers["www-authenticate"] == 'Bearer realm="pilothouse"'
    assert answer.headers["content-type"] == "application/problem+json"
    assert (problem["code"], problem["status"]) == ("UNAUTHORIZED", 401)
    assert "Authorization: Bearer TOKEN" in problem["hint"]


async def test_a_wrong_token_is_told_from_none_and_not_repeated(guarded: HttpRobot) -> None:
    answer = await guarded.http.get("/systems", headers={"Authorization": "Bearer wr0ng"})

    challenge = 'Bearer realm="pilothouse", error="invalid_token"'
    assert (answer.status_code, answer.headers["www-authenticate"]) == (401, challenge)
    assert "wr0ng" not in answer.text


@pytest.mark.parametrize("name", ["token", "access_token", "authorization"])
async def test_a_token_in_the_query_is_not_read(name: str, guarded: HttpRobot) -> None:
    assert (await guarded.http.get(f"/systems?{name}={TOKEN}")).status_code == 401


async def test_a_refusal_tells_browsers_to_be_strict_too(guarded: HttpRobot) -> None:
    answer = await guarded.http.get("/systems")

    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["cache-control"] == "no-store"


async def test_who_fails_is_counted_and_logged_without_what_it_tried(
    guarded: HttpRobot, caplog: pytest.LogCaptureFixture
) -> None:
    events = guarded.supervisor.events.newest
    for _ in range(5):
        await guarded.http.get("/systems", headers={"Authorization": "Bearer wr0ng"})

    assert guarded.app.state.refusals.counts == {401: 5}
    assert len(caplog.messages) == 1
    assert "127.0.0.1" in caplog.text
    assert "wr0ng" not in caplog.text
    assert guarded.supervisor.events.newest == events


async def test_a_websocket_passes_since_a_browser_cannot_send_a_header() -> None:
    sent = await messages_of(gate(Access.with_token(TOKEN)), websocket_scope({"host": "robot"}))

    assert sent[0]["status"] == 200


async def test_what_a_body_holds_is_not_looked_at_without_the_token(guarded: HttpRobot) -> None:
    answer = await guarded.http.post("/tasks", content=b"{" * 100)

    assert json.loads(answer.content)["code"] == "UNAUTHORIZED"
