"""Between network and protocol: whatever is sent, a turn has a bounded amount of work."""

import asyncio

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from api.serving.http_protocol import MAX_HEAD_BYTES
from api.serving.intake import READ_BYTES, Dispensable
from api.serving.pieces import HEAD_COST
from api.serving.turns import BUDGET
from tests.support.flooded_wire import FloodedService
from tests.support.waiting import until

GET = b"GET /x HTTP/1.1\r\nHost: a\r\n\r\n"
HANDSHAKE = (
    b"GET /ws HTTP/1.1\r\nHost: a\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
)
CHUNKED = b"POST /x HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n"
MAX_HEADS = BUDGET // HEAD_COST + 1
MAX_BYTES = MAX_HEAD_BYTES + 100 * READ_BYTES


async def test_pipelined_requests_are_taken_a_few_in_a_turn() -> None:
    service = FloodedService()
    clients = [service.connect() for _ in range(20)]
    for client in clients:
        client.send(GET * 10_000)

    for _ in range(50):
        before = len(service.handed_on)
        service.loop.turn()
        assert len(service.handed_on) - before <= MAX_HEADS
        await asyncio.sleep(0)
        for client in clients:
            client.deliver()

    for client in clients:
        client.lose()


async def test_what_waits_is_not_added_to() -> None:
    service = FloodedService()
    client = service.connect()

    client.send(GET * 10_000)
    rest = len(client.unread)
    client.deliver()

    assert not client.raw.reads
    assert len(client.unread) == rest
    client.lose()


async def test_all_is_answered_in_the_end() -> None:
    service = FloodedService()
    client = service.connect()

    client.send(GET * 100)
    for _ in range(1_000):
        service.loop.turn()
        await asyncio.sleep(0)

    assert client.raw.written.count(b"HTTP/1.1 200") == 100
    client.lose()


async def test_a_stop_overtakes_a_flood() -> None:
    service = FloodedService()
    flood = [service.connect() for _ in range(110)]
    for client in flood:
        client.send(GET * 500)
    owner = service.connect()

    owner.send(b"PUT /emergency_stop HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\n{}")
    service.loop.turn()
    # Also its body: no further turn is needed.
    await until(lambda: b"200" in owner.raw.written)
    assert owner.intake.inner.dispensable is Dispensable.AT_ONCE
    assert not owner.intake.inner.in_message

    for client in (owner, *flood):
        client.lose()


async def test_frames_sent_with_the_handshake_are_not_lost() -> None:
    service = FloodedService()
    client = service.connect()

    client.send(HANDSHAKE)
    await until(lambda: b"101" in client.raw.written)
    client.send(b"\x89\x80\0\0\0\0" * 1_000)
    for _ in range(100):
        service.loop.turn()

    assert client.raw.written.count(b"\x8a\x00") == 1_000
    client.lose()


async def test_a_protocol_that_fails_harms_only_its_connection(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    service = FloodedService()
    broken, other = service.connect(), service.connect()

    def fail(data: bytes) -> None:
        raise ValueError(data)

    monkeypatch.setattr(broken.intake.inner, "data_received", fail)
    broken.send(GET)
    other.send(GET)
    service.loop.turn()
    await until(lambda: b"200" in other.raw.written)

    assert broken.raw.aborted
    other.lose()


_BYTES = st.one_of(
    st.binary(max_size=300),
    st.sampled_from(
        [
            GET,
            HANDSHAKE,
            CHUNKED,
            b"1\r\na\r\n",
            b"0\r\n",
            b"a: b\r\n",
            b"\r\n",
            b"GET /x HTTP/1.1\r\n a: folded\r\n\r\n",
            b"POST /x HTTP/1.1\r\nHost: a\r\nContent-Length: 18446744073709551615\r\n\r\n",
            b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
            b"\x16\x03\x01\x02\x00\x01\x00",
            b"\x89\x80\0\0\0\0",
            b"\x01\x80\0\0\0\0",
            b"\x00\x80\0\0\0\0",
        ]
    ),
)


@settings(deadline=None, max_examples=60)
@given(st.lists(st.tuples(_BYTES, st.integers(1, 2_000)), min_size=1, max_size=6))
def test_whatever_is_sent_a_turn_is_bounded(parts: list[tuple[bytes, int]]) -> None:
    async def flood() -> None:
        service = FloodedService()
        clients = [service.connect() for _ in range(5)]
        data = b"".join(part * count for part, count in parts)[:300_000]
        for client in clients:
            client.send(data)
        for _ in range(60):
            before = len(service.handed_on)
            service.loop.turn()
            assert sum(service.handed_on[before:]) <= MAX_BYTES
            await asyncio.sleep(0)
            for client in clients:
                client.deliver()
        for client in clients:
            client.lose()
        for task in tuple(service.state.tasks):
            await task

    asyncio.run(flood())
