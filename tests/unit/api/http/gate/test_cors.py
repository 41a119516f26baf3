"""What pages of allowed origins can do, and what pages of others cannot."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import httpx
import pytest
from fastapi import FastAPI
from hypothesis import given, settings
from hypothesis import strategies as st

from api.app import create_app
from api.http.access import Access
from api.http.gate.origin import OriginGate
from api.http.gate.origins import AllowedOrigins
from api.http.gate.refusals import Refusals
from tests.support.asgi import answer_200, status_of, websocket_scope
from tests.support.http_robot import HttpRobot, http_scope
from tests.support.live_robot import make_supervisor
from tests.support.manual_clock import ManualClock

GRAFANA = {"origin": "http://grafana:3000"}
TOKEN = "a token of good length"
BEARER = {"authorization": f"Bearer {TOKEN}"}
STOP = {"engaged": True}


@asynccontextmanager
async def service(access: Access | None = None) -> AsyncIterator[httpx.AsyncClient]:
    app: FastAPI = create_app(
        make_supervisor(),
        allowed_hosts=["robot"],
        allowed_origins=AllowedOrigins(["http://grafana:3000"]),
        access=access,
    )
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url="http://robot") as client:
        yield client


async def test_a_page_of_an_allowed_origin_reads() -> None:
    async with service() as http:
        answer = await http.get(
            "/system_state", headers={**GRAFANA, "sec-fetch-site": "cross-site"}
        )

    assert answer.status_code == 200
    assert answer.headers["access-control-allow-origin"] == "http://grafana:3000"
    assert "access-control-allow-credentials" not in answer.headers
    assert "Origin" in answer.headers["vary"]


async def test_a_cache_is_told_that_answers_differ_by_origin() -> None:
    async with service() as http:
        own = await http.get("/model")
        other = await http.get("/model", headers={"origin": "http://evil.example"})

    assert own.headers["vary"] == other.headers["vary"] == "Accept, Origin"
    assert "access-control-allow-origin" not in other.headers


async def test_it_writes_with_the_token() -> None:
    async with service(Access.with_token(TOKEN)) as http:
        without = await http.put("/emergency_stop", json=STOP, headers=GRAFANA)
        answer = await http.put("/emergency_stop", json=STOP, headers={**GRAFANA, **BEARER})

    assert without.status_code == 401
    assert without.headers["access-control-allow-origin"] == GRAFANA["origin"]
    assert answer.status_code == 200
    assert "Pilothouse-Durable" in answer.headers["access-control-expose-headers"].split(", ")


async def test_without_a_token_it_only_reads() -> None:
    async with service() as http:
        answer = await http.put("/emergency_stop", json=STOP, headers=GRAFANA)
        calculated = await http.post("/inference", json={}, headers=GRAFANA)

    assert (answer.status_code, answer.json()["code"]) == (403, "FOREIGN_ORIGIN")
    assert "PILOTHOUSE_TOKEN" in answer.json()["hint"]
    assert calculated.status_code == 200


async def test_a_preflight_needs_no_token() -> None:
    asked = {"access-control-request-method": "PUT"}
    async with service(Access.with_token(TOKEN)) as http:
        answer = await http.options("/emergency_stop", headers={**GRAFANA, **asked})
        foreign = await http.options("/emergency_stop", headers={"origin": "http://evil", **asked})

    assert answer.status_code == 204
    assert answer.headers["access-control-allow-origin"] == GRAFANA["origin"]
    assert "PUT" in answer.headers["access-control-allow-methods"]
    assert "Authorization" in answer.headers["access-control-allow-headers"]
    assert foreign.status_code == 403
    assert not any(name.startswith("access-control") for name in foreign.headers)


def gate() -> OriginGate:
    allowed = AllowedOrigins(["http://grafana:3000"])
    return OriginGate(answer_200, [], Refusals(ManualClock()), origins=allowed)


@pytest.mark.parametrize(
    ("origin", "status"), [("http://grafana:3000", 200), ("http://evil.example", None)]
)
async def test_a_websocket_is_for_allowed_origins(origin: str, status: int | None) -> None:
    scope = websocket_scope({"origin": origin, "host": "127.0.0.1"})
    reached = []

    async def app(scope: object, receive: object, send: object) -> None:
        reached.append(scope)

    allowed = AllowedOrigins(["http://grafana:3000"])
    await OriginGate(app, [], Refusals(ManualClock()), origins=allowed)(scope, _never, _ignore)

    assert bool(reached) is (status == 200)


async def _never() -> dict[str, object]:
    raise AssertionError


async def _ignore(message: object) -> None:
    del message


CROSS = {"sec-fetch-site": "cross-site"}


@pytest.mark.parametrize(
    ("path", "more", "status"),
    [
        ("/nodes/x", {"sec-fetch-mode": "no-cors", "sec-fetch-dest": "image"}, 403),
        ("/", {"sec-fetch-mode": "no-cors", "sec-fetch-dest": "script"}, 403),
        ("/", {"sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}, 200),
        ("/docs", {"sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}, 200),
        ("/", {"sec-fetch-mode": "navigate", "sec-fetch-dest": "iframe"}, 403),
        ("/system_state", {"sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}, 403),
    ],
)
async def test_another_site_may_link_to_the_page_and_ask_for_nothing_else(
    path: str, more: dict[str, str], status: int, robot: HttpRobot
) -> None:
    answer = await robot.http.get(path, headers={**CROSS, **more})

    assert answer.status_code == status


@pytest.mark.parametrize("site", ["same-origin", "same-site", "none"])
async def test_other_requests_of_browsers_pass(site: str, robot: HttpRobot) -> None:
    answer = await robot.http.get("/system_state", headers={"sec-fetch-site": site})

    assert answer.status_code == 200


TWICE = {
    "origin": ("http://robot:8000", "http://evil.example"),
    "host": ("robot:8000", "evil.example"),
    "content-type": ("application/json", "text/plain"),
    "sec-fetch-site": ("same-origin", "cross-site"),
}


@pytest.mark.parametrize("name", TWICE)
@pytest.mark.parametrize("is_joined", [False, True])
async def test_a_header_that_decides_is_refused_if_it_is_there_twice(
    name: str, is_joined: bool, robot: HttpRobot
) -> None:
    values = [", ".join(TWICE[name])] if is_joined else list(TWICE[name])
    headers = [(name, value) for value in values]
    if name != "origin":
        headers.append(("origin", "http://robot:8000"))
    if name != "content-type":
        headers.append(("content-type", "application/json"))
    request = robot.http.build_request("PUT", "/emergency_stop", json=STOP, headers=headers)

    answer = await robot.http.send(request)

    assert answer.status_code in (400, 403, 415)
    assert (await robot.get("/emergency_stop"))["engaged"] is False


ORIGINS = st.lists(
    st.sampled_from(["http://127.0.0.1", "http://grafana:3000", "http://evil", "null", "*", ""]),
    min_size=2,
    max_size=3,
)


@given(origins=ORIGINS)
@settings(max_examples=40)
async def test_no_list_of_origins_writes_or_opens_a_websocket(origins: list[str]) -> None:
    for values in (origins, [", ".join(origins)]):
        scope = http_scope("PUT", "/emergency_stop", host="127.0.0.1")
        pairs = [(b"origin", value.encode()) for value in values]
        request = {**scope, "headers": [*scope["headers"], *pairs]}

        assert await status_of(gate(), request) == 403
