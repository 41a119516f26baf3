"""What a connection leaves behind: nothing, without a garbage collection, whatever it did."""

import asyncio
import gc
from collections.abc import Iterator

import pytest

from tests.support.flooded_wire import FloodedService
from tests.support.floods.flood import websocket_handshake
from tests.support.http_robot import http_robot

LINE = b" HTTP/1.1\r\nHost: robot\r\n"
HANDSHAKE = websocket_handshake("/ws").replace(b"127.0.0.1", b"robot")
ROSBRIDGE = websocket_handshake("/rosbridge").replace(b"127.0.0.1", b"robot")


def frame(opcode: int, payload: bytes) -> bytes:
    return bytes((0x80 | opcode, 0x80 | len(payload))) + b"\0\0\0\0" + payload


@pytest.fixture
def no_collection() -> Iterator[None]:
    gc.collect()
    gc.disable()
    yield
    gc.enable()


@pytest.mark.usefixtures("no_collection")
@pytest.mark.parametrize(
    "sent",
    [
        [],
        [b"GET /x"],
        [b"\0"],
        [b"GET /livez" + LINE + b"\r\n"],
        [b"GET /x" + LINE + b"\r\n"],
        [b"PUT /emergency_stop" + LINE + b'Content-Length: 16\r\n\r\n{"engaged": true}'],
        [b"PUT /emergency_stop" + LINE + b"Content-Length: 16\r\n\r\n{"],
        [b"PUT /emergency_stop" + LINE + b"Content-Length: 1\r\n\r\n{"],
        [HANDSHAKE],
        [HANDSHAKE, frame(1, b'{"type": "resync"}')],
        [HANDSHAKE, frame(1, b"?")],
        [HANDSHAKE, frame(9, b"")],
        [HANDSHAKE, frame(11, b"")],
        [HANDSHAKE, frame(8, b"\x03\xe8")],
        [HANDSHAKE, b"\x81"],
        [ROSBRIDGE, frame(1, b'{"op": "subscribe", "topic": "/system_state"}')],
    ],
)
async def test_a_connection_that_ends_leaves_no_garbage(sent: list[bytes]) -> None:
    async with http_robot() as robot:
        service = FloodedService(app=robot.app)
        # The first use of each class makes caches that stay.
        await _connect(service, sent)
        gc.collect()
        for _ in range(5):
            await _connect(service, sent)

        assert gc.collect() == 0
        assert not service.state.tasks
        assert not service.state.connections
        assert not len(service.connections)


async def _connect(service: FloodedService, sent: list[bytes]) -> None:
    client = service.connect()
    for data in sent:
        client.send(data)
        await _pass_turns(service)
    client.lose()
    await _pass_turns(service)


async def _pass_turns(service: FloodedService) -> None:
    for _ in range(40):
        service.loop.turn()
        await asyncio.sleep(0)
