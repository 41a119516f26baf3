import asyncio
import json

import pytest

from api.serving.http_protocol import (
    BODY_TIMEOUT_S,
    HEAD_TIMEOUT_S,
    MAX_HEAD_BYTES,
    UNREAD_TIMEOUT_S,
    urgency_of,
)
from api.serving.intake import Dispensable
from api.serving.turns import Urgency
from tests.support.flooded_wire import Client, FloodedService
from tests.support.waiting import until

LINE = b"GET /x HTTP/1.1\r\nHost: a\r\n"


def sent(data: bytes) -> tuple[FloodedService, Client]:
    service = FloodedService()
    client = service.connect()
    client.send(data)
    for _ in range(200):
        service.loop.turn()
        client.deliver()
    return service, client


@pytest.mark.parametrize(
    ("data", "status", "code"),
    [
        (b"\x16\x03\x01\x02\x00\x01\x00", 400, "MALFORMED_REQUEST"),
        (b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 400, "MALFORMED_REQUEST"),
        (b"GET /x HTTP/1.1\r\nHost: a\r\nContent-Length: -1\r\n\r\n", 400, "MALFORMED_REQUEST"),
        (LINE + b"a: b\r\n" * 101 + b"\r\n", 431, "HEAD_TOO_LARGE"),
        (LINE + b"a: " + b"b" * MAX_HEAD_BYTES, 431, "HEAD_TOO_LARGE"),
    ],
)
async def test_what_is_no_acceptable_head_is_answered_and_counted(
    data: bytes, status: int, code: str
) -> None:
    service, client = sent(data)

    head, _, body = bytes(client.raw.written).partition(b"\r\n\r\n")
    problem = json.loads(body)
    assert head.startswith(b"HTTP/1.1 %d" % status)
    assert (problem["status"], problem["code"]) == (status, code)
    assert client.raw.is_closing()
    assert service.closings.counts == {"malformed": 1}
    client.lose()


async def test_trailers_without_end_are_ended_and_not_kept() -> None:
    head = b"POST /x HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n"
    _, client = sent(head + b"a: b\r\n" * 20_000)

    assert client.raw.is_closing()
    client.lose()


async def test_a_slow_head_and_a_slow_body_are_overdue() -> None:
    now = asyncio.get_running_loop().time()
    _, silent = sent(b"")
    _, slow = sent(b"POST /x HTTP/1.1\r\nHost: a\r\nContent-Length: 9\r\n\r\n1")

    assert silent.intake.inner.overdue(now) is None
    assert silent.intake.inner.overdue(now + HEAD_TIMEOUT_S + 1) == "head"
    assert slow.intake.inner.overdue(now + BODY_TIMEOUT_S + 1) == "body"
    silent.lose()
    slow.lose()


async def test_whoever_does_not_read_its_answer_is_overdue() -> None:
    now = asyncio.get_running_loop().time()
    _, client = sent(LINE + b"\r\n")
    client.raw.unsent = 10

    assert client.intake.inner.overdue(now) is None
    client.raw.unsent = 5
    assert client.intake.inner.overdue(now + UNREAD_TIMEOUT_S) is None
    assert client.intake.inner.overdue(now + 2 * UNREAD_TIMEOUT_S + 1) == "unread"
    client.lose()


async def test_a_connection_is_dispensable_between_its_requests() -> None:
    _, client = sent(b"")
    seen = [client.intake.inner.dispensable]

    client.send(LINE + b"\r\n")
    seen.append(client.intake.inner.dispensable)
    await until(lambda: b"200" in client.raw.written)
    seen.append(client.intake.inner.dispensable)

    assert seen == [Dispensable.AT_ONCE, Dispensable.NOT, Dispensable.AT_ONCE]
    client.lose()


@pytest.mark.parametrize(
    ("request_line", "urgency"),
    [
        ("PUT /emergency_stop", Urgency.STOP),
        ("POST /signals/estop", Urgency.STOP),
        ("POST /signals", Urgency.PAUSE),
        ("POST /signals/battery_level", Urgency.PAUSE),
        ("PUT /holds/operator", Urgency.PAUSE),
        ("DELETE /tasks/current", Urgency.PAUSE),
        ("GET /emergency_stop", Urgency.REST),
        ("GET /signals", Urgency.REST),
        ("POST /tasks", Urgency.REST),
    ],
)
def test_a_stop_comes_first_and_then_what_else_makes_the_robot_safer(
    request_line: str, urgency: Urgency
) -> None:
    assert urgency_of(f"{request_line} HTTP/1.1\r\n".encode()) is urgency


async def test_a_request_that_changes_something_costs_more_than_one_that_asks() -> None:
    client = FloodedService().connect()
    protocol = client.intake.inner

    asked = protocol.next_piece(bytearray(b"GET /holds HTTP/1.1\r\n\r\n"))
    changes = protocol.next_piece(bytearray(b"PUT /holds/a HTTP/1.1\r\n\r\n"))

    assert changes.cost > 2 * asked.cost
    client.lose()
