import asyncio
import socket

from tests.support.flooded_wire import FloodedService
from tests.support.waiting import until


async def test_the_oldest_without_a_request_makes_room() -> None:
    service = FloodedService()
    busy, oldest, newest = (service.connect() for _ in range(3))
    busy.send(b"GET /x HTTP/1.1\r\nHost: a\r\n\r\n")

    assert service.connections.make_room()

    assert oldest.raw.aborted
    assert not newest.raw.aborted
    assert not busy.raw.aborted
    assert service.closings.counts == {"full": 1}
    for client in (busy, oldest, newest):
        client.lose()


async def test_there_is_no_room_when_all_are_being_answered() -> None:
    service = FloodedService()
    client = service.connect()
    client.send(b"GET /x HTTP/1.1\r\nHost: a\r\n\r\n")

    assert not service.connections.make_room()

    client.lose()


async def test_a_new_connection_is_admitted_however_many_are_silent() -> None:
    service = FloodedService(most=3)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        service.connections.start([listener], service.make)
        address, port = listener.getsockname()
        silent = [await asyncio.open_connection(address, port) for _ in range(10)]
        await until(lambda: service.closings.counts["full"] >= 7)

        assert len(service.connections) <= 3

        service.connections.stop()
        for _, writer in silent:
            writer.transport.abort()
        await until(lambda: not len(service.connections))
