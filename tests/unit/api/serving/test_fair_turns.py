"""Those who send without end, and those who read: each gets its turns."""

import asyncio
import json

from api.http.limits import ServiceLimits
from api.serving.turns import Turns
from domain.timebase import NANOSECONDS_PER_SECOND
from tests.support.flooded_wire import Client, FloodedService
from tests.support.floods.flood import websocket_handshake
from tests.support.http_robot import http_robot
from tests.support.waiting import until
from tests.support.websocket import texts_of

HOST = b"Host: robot\r\nContent-Length: 0\r\n\r\n"
HANDSHAKE = websocket_handshake("/ws?topics=events").replace(b"127.0.0.1", b"robot")
# Time stands still, so that all others would be rejected.
LIMITS = ServiceLimits(requests_per_s=NANOSECONDS_PER_SECOND)
MAX_BEHIND = 200
"""Events; 10,000 are kept, and a reader that is further behind is told of a gap."""


async def test_a_fast_reader_keeps_up_while_50_clients_set_and_release_holds() -> None:
    async with http_robot(limits=LIMITS) as robot:
        service = FloodedService(app=robot.app, turns=Turns.of(asyncio.get_running_loop()))
        reader = service.connect()
        reader.send(HANDSHAKE)
        await until(lambda: b'"hello"' in reader.raw.written)
        head = reader.raw.written.index(b"\r\n\r\n") + 4
        setters = [service.connect() for _ in range(50)]
        for number, setter in enumerate(setters):
            owner = b"/holds/client-%d HTTP/1.1\r\n" % number
            setter.unread += (b"PUT " + owner + HOST + b"DELETE " + owner + HOST) * 1_000

        seen = 0
        for _ in range(250):
            await asyncio.sleep(0)
            for setter in setters:
                setter.deliver()
            seen = max(seen, robot.supervisor.events.newest - _newest_id(reader))
        ids = _ids(reader, head)

        assert robot.supervisor.events.newest > 1_000
        assert seen <= MAX_BEHIND
        assert ids == list(range(ids[0], ids[0] + len(ids)))
        for client in (reader, *setters):
            client.lose()
        await until(lambda: not service.state.tasks)


def _newest_id(reader: Client) -> int:
    _, found, newest = bytes(reader.raw.written[-1_000:]).rpartition(b'"id":')
    return int(newest.split(b",")[0]) if found else 0


def _ids(reader: Client, head: int) -> list[int]:
    frames = map(json.loads, texts_of(bytes(reader.raw.written[head:])))
    return [frame["id"] for frame in frames if frame["type"] == "event"]
