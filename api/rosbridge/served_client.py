"""One client of rosbridge from when it was let in until it goes."""

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


class ServedClient:
    """Hears what it says, and writes what it is to be told."""

    def __init__(self, bridge: Bridge, connection: Connection, address: str) -> None:
        """Begin.

        Args:
            bridge: What all clients share.
            connection: It is accepted.
            address: Of the client, without a port.
        """
        self._bridge = bridge
        self._connection = connection
        self._address = address
        self._woken = asyncio.Event()
        self._queue = SendQueue(self._woken.set)
        self._wire = Wire(connection, bridge.clock)

    async def serve(self, receive: Callable[[], Awaitable[Mapping[str, Any]]]) -> None:
        """Serve the client until it goes or is cut off.

        Args:
            receive: Returns the next message, as ASGI has it.
        """
        self._connection.listen(self._wire)
        try:
            async with asyncio.TaskGroup() as tasks:
                writing = tasks.create_task(self._write(), name="rosbridge writer")
                caller = Actor(way="rosbridge", address=self._address)
                session = Session(self._bridge, self._queue, caller, tasks.create_task)
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
        """Read ahead, so that a reading of the emergency stop waits for nothing said before it."""
        while True:
            message = await receive()
            if is_urgent(message):
                self._wire.heard()
                session.hear(message)
                await asyncio.sleep(0)
                continue
            await ahead.put(message)
            if message["type"] == "websocket.disconnect":
                return

    async def _hear(self, session: Session, ahead: ReadAhead) -> None:
        """Do what one message after the other asks."""
        while True:
            message = await ahead.get()
            if message["type"] == "websocket.disconnect":
                return
            self._wire.heard()
            if self._connection.transport.is_closing():
                session.leave()
            # Of all clients one after the other: together, the largest messages of fifty would take
            # longer than the tick may wait.
            async with self._bridge.turn:
                session.hear(message)
                await asyncio.sleep(0)

    async def _write(self) -> None:
        """Write until cancelled, or until the client has to be cut off.

        Nothing waits in here for the client: what it does not take stays in the queue.
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
                    log.info("dropped %s: it does not read", self._address)
                    wire.cut_off()
                    return
                await asyncio.sleep(0)
