"""One rosbridge client, from its authentication until it disconnects."""

import asyncio
import logging
from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from api.rosbridge.bridge import Bridge
from api.rosbridge.read_ahead import ReadAhead, is_urgent
from api.rosbridge.send_queue import SendQueue
from api.rosbridge.session import Session
from api.rosbridge.wire import Wire
from api.streaming.websocket_frames import Connection
from domain.actor import Actor

log = logging.getLogger(__name__)

_TURNS_TO_READ = 60
"""Most turns of the loop between two messages of a client that sends faster than it is heard."""
_QUIET_TURNS = 4
"""So many turns without a message show that none waits: reading one takes up to three."""


class ServedClient:
    """Reads the messages of a client, and writes those to it."""

    def __init__(
        self, bridge: Bridge, connection: Connection, address: str, *, reads_only: bool = False
    ) -> None:
        """Prepare.

        Args:
            bridge: Shared by all clients.
            connection: An accepted connection.
            address: Of the client, without a port.
            reads_only: Whether it may only read.
        """
        self._reads_only = reads_only
        self._bridge = bridge
        self._connection = connection
        self._address = address
        self._woken = asyncio.Event()
        self._queue = SendQueue(self._woken.set)
        self._wire = Wire(connection, bridge.clock)

    async def serve(self, receive: Callable[[], Awaitable[Mapping[str, Any]]]) -> None:
        """Serve the client until it disconnects or is disconnected.

        Args:
            receive: Returns the next ASGI message.
        """
        self._connection.listen(self._wire)
        try:
            async with asyncio.TaskGroup() as tasks:
                writing = tasks.create_task(self._write(), name="rosbridge writer")
                caller = Actor(way="rosbridge", address=self._address)
                session = Session(
                    self._bridge,
                    self._queue,
                    caller,
                    tasks.create_task,
                    reads_only=self._reads_only,
                )
                ahead = ReadAhead()
                reading = tasks.create_task(self._read(session, ahead, receive))
                try:
                    await self._hear(session, ahead)
                finally:
                    session.end()
                    reading.cancel()
                    writing.cancel()
        finally:
            self._connection.listen(None)

    async def _read(
        self,
        session: Session,
        ahead: ReadAhead,
        receive: Callable[[], Awaitable[Mapping[str, Any]]],
    ) -> None:
        """Read ahead, so that a reading of the emergency stop overtakes earlier messages."""
        while True:
            message = await receive()
            if is_urgent(message):
                self._wire.heard()
                ahead.overtake()
                session.hear(message)
                await asyncio.sleep(0)
                continue
            await ahead.put(message)
            if message["type"] == "websocket.disconnect":
                return

    async def _hear(self, session: Session, ahead: ReadAhead) -> None:
        """Process messages one after the other."""
        while True:
            message, number = await ahead.get()
            if message["type"] == "websocket.disconnect":
                return
            self._wire.heard()
            if self._connection.transport.is_closing():
                session.leave()
            # One message of all clients at a time: fifty large ones in one pass of the event loop
            # would delay the tick for too long.
            async with self._bridge.turn:
                session.hear(message, overtaken=ahead.is_overtaken(number))
                await asyncio.sleep(0)
            await _let_read(ahead)

    async def _write(self) -> None:
        """Write until cancelled, or until the client must be disconnected.

        This never waits for the client: what it does not read stays in the queue.
        """
        wire, queue = self._wire, self._queue
        with self._bridge.frames.watch(self._woken.set):
            while True:
                await self._woken.wait()
                self._woken.clear()
                if wire.is_free():
                    texts = queue.take(self._bridge.clock.now())
                    if texts:
                        wire.write(texts)
                    wire.ping()
                    if queue.has_more:
                        self._woken.set()
                if wire.is_silent() or queue.overflowed:
                    log.info("dropped client %s: it does not read", self._address)
                    wire.cut_off()
                    return
                await asyncio.sleep(0)


async def _let_read(ahead: ReadAhead) -> None:
    """Let what has arrived be read first, a message in a few turns: a stop may be among it."""
    arrived, quiet = ahead.arrived, 0
    for _ in range(_TURNS_TO_READ):
        await asyncio.sleep(0)
        quiet = quiet + 1 if ahead.arrived == arrived else 0
        arrived = ahead.arrived
        if quiet == _QUIET_TURNS:
            return
