from http import HTTPStatus

import pytest

from api.http.gate.refusals import Refusals, address_of, refuse
from api.http.problems import make_problem
from tests.support.asgi import websocket_scope
from tests.support.http_robot import http_scope
from tests.support.manual_clock import ManualClock

FORBIDDEN, UNAUTHORIZED = HTTPStatus.FORBIDDEN, HTTPStatus.UNAUTHORIZED


async def test_a_flood_of_refusals_fills_no_log(caplog: pytest.LogCaptureFixture) -> None:
    clock = ManualClock()
    refusals = Refusals(clock)

    for _ in range(30):
        for _ in range(100):
            refusals.note(UNAUTHORIZED, "10.0.0.1")
        await clock.advance(0.1)

    assert refusals.counts == {UNAUTHORIZED: 3_000}
    assert caplog.messages == [
        "401 Unauthorized: rejected 10.0.0.1",
        "401 Unauthorized: rejected 10.0.0.1, and 999 more since the last line",
        "401 Unauthorized: rejected 10.0.0.1, and 999 more since the last line",
    ]


def test_one_kind_of_refusal_does_not_hide_another(caplog: pytest.LogCaptureFixture) -> None:
    refusals = Refusals(ManualClock())

    refusals.note(UNAUTHORIZED, "10.0.0.1")
    refusals.note(FORBIDDEN, "10.0.0.2")

    assert len(caplog.messages) == 2
    assert refusals.counts == {UNAUTHORIZED: 1, FORBIDDEN: 1}


async def test_a_websocket_is_refused_before_it_is_accepted() -> None:
    sent = []
    problem = make_problem(FORBIDDEN, "NO", "no", "/ws")

    async def send(message: object) -> None:
        sent.append(message)

    async def receive() -> dict[str, object]:
        return {"type": "websocket.connect"}

    await refuse(problem, websocket_scope({}), receive, send)

    assert sent == [{"type": "websocket.close", "code": 1008}]


def test_a_client_without_an_address_has_none() -> None:
    assert address_of(http_scope("GET", "/")) == "10.0.0.1"
    assert address_of({**http_scope("GET", "/"), "client": None}) == "unknown"
