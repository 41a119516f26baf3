"""What a client in the middle of its handshake is told when the service ends."""

import asyncio

import pytest

from tests.support.flooded_wire import Client, FloodedService
from tests.support.floods.flood import websocket_handshake
from tests.support.http_robot import http_robot


@pytest.mark.parametrize("path", ["/ws", "/rosbridge"])
async def test_a_handshake_that_is_not_done_is_answered_503_and_leaves_no_traceback(
    path: str, caplog: pytest.LogCaptureFixture
) -> None:
    async with http_robot() as robot:
        service = FloodedService(app=robot.app)
        client = service.connect()
        client.send(websocket_handshake(path).replace(b"127.0.0.1", b"robot"))

        end(service)
        await pass_turns(service, client)

    assert client.raw.written.startswith(b"HTTP/1.1 503 ")
    assert client.raw.written.count(b"HTTP/1.1") == 1
    assert not [record for record in caplog.records if record.exc_info]
    assert not service.state.tasks


async def test_a_client_that_is_let_in_is_told_1012() -> None:
    async with http_robot() as robot:
        service = FloodedService(app=robot.app)
        client = service.connect()
        client.send(websocket_handshake("/ws").replace(b"127.0.0.1", b"robot"))
        for _ in range(20):
            await asyncio.sleep(0)

        end(service)
        await pass_turns(service, client)

    assert client.raw.written.startswith(b"HTTP/1.1 101 ")
    assert client.raw.written.endswith(b"\x88\x02\x03\xf4")


def end(service: FloodedService) -> None:
    """Do what the server does with each connection when it ends."""
    for connection in tuple(service.state.connections):
        connection.shutdown()


async def pass_turns(service: FloodedService, client: Client) -> None:
    """Let the application see the end first, and then that of the connection."""
    assert client.raw.is_closing()
    await _turns(service)
    client.lose()
    await _turns(service)


async def _turns(service: FloodedService) -> None:
    for _ in range(40):
        service.loop.turn()
        await asyncio.sleep(0)
