"""`WS /ws`: frames and events to each client at its own pace, and readings from it.

Nothing is queued for a client. Its writer looks at what is newest whenever it has sent what it had;
a slow client so skips frames, and one that does not take a frame for seconds is dropped.
"""

import asyncio
import logging
from collections.abc import Mapping
from contextlib import ExitStack
from typing import Any

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from api.streaming.hub import StreamHub, StreamHubDep
from api.streaming.messages import read_client_message
from api.streaming.query import StreamQuery, read_stream_query
from domain.errors import PilothouseError
from service.event_log import EventReader, Gap
from service.frame_feed import FrameReader

router = APIRouter()
log = logging.getLogger(__name__)

SEND_TIMEOUT_S = 5.0
_CLOSE_TIMEOUT_S = 1.0
_EVENTS_AT_ONCE = 32

_POLICY_VIOLATION = 1008
_TRY_AGAIN_LATER = 1013


@router.websocket("/ws")
async def stream(socket: WebSocket, hub: StreamHubDep) -> None:
    """Serve one client until it goes, is too slow, or the service ends.

    What is wrong with the address is told after the handshake, as a `problem` frame and with close
    code 1008, since a browser does not show a page why its handshake was refused.
    """
    await socket.accept()
    if hub.is_full:
        await socket.close(_TRY_AGAIN_LATER, "too many clients")
        return
    with hub.count_client():
        client = _Client(socket, hub)
        try:
            query = read_stream_query(socket.query_params)
        except PilothouseError as error:
            await client.refuse(error)
        else:
            await client.serve(query)


class _GoneError(Exception):
    """The client is not there any more."""


class _TooSlowError(Exception):
    """The client did not take what was sent to it."""


class _Client:
    """One client: a task that reads what it says, and one that writes what it gets."""

    def __init__(self, socket: WebSocket, hub: StreamHub) -> None:
        self._socket = socket
        self._hub = hub
        self._address = socket.client.host if socket.client else "unknown"

    async def refuse(self, error: PilothouseError) -> None:
        """Say what is wrong with the address, and close."""
        try:
            await self._send(self._hub.encoder.problem(error))
            await self._close(_POLICY_VIOLATION, error.code)
        except (_GoneError, _TooSlowError):
            pass

    async def serve(self, query: StreamQuery) -> None:
        """Read and write until either side ends."""
        try:
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(self._read(), name="stream reader")
                tasks.create_task(self._write(query), name="stream writer")
        except* _GoneError:
            pass
        except* _TooSlowError:
            self._hub.dropped += 1
            log.info("dropped %s: it read nothing for %g s", self._address, SEND_TIMEOUT_S)
            await self._close(_TRY_AGAIN_LATER, "too slow")

    # --- writing ---------------------------------------------------------------------------------

    async def _write(self, query: StreamQuery) -> None:
        supervisor = self._hub.supervisor
        frames = FrameReader(supervisor.frames) if query.wants_state else None
        events = None
        woken = asyncio.Event()
        with ExitStack() as watching:
            if query.wants_state:
                watching.enter_context(supervisor.frames.watch(woken.set))
            if query.wants_events:
                events = EventReader(supervisor.events, query.after, query.epoch)
                watching.enter_context(supervisor.events.watch(woken.set))
            await self._send(self._hub.encoder.hello(query.topics))
            while True:
                woken.clear()
                more = events is not None and await self._send_events(events)
                if frames is not None:
                    await self._send_frame(frames, query.topics)
                # A transport with room does not let others run; a long history must not keep the
                # loop for itself.
                await (asyncio.sleep(0) if more else woken.wait())

    async def _send_events(self, events: EventReader) -> bool:
        """Send some of the events that are not sent yet; tell whether there may be more."""
        encoder = self._hub.encoder
        found = events.take(_EVENTS_AT_ONCE)
        for item in found:
            await self._send(encoder.gap(item) if isinstance(item, Gap) else encoder.event(item))
        return bool(found)

    async def _send_frame(self, frames: FrameReader, topics: frozenset[str]) -> None:
        taken = frames.take()
        if taken is not None:
            frame, skipped = taken
            encoder = self._hub.encoder
            self._hub.skipped += skipped
            await encoder.prepare(frame, topics)
            await self._send(encoder.frame(frame, skipped, topics))

    async def _send(self, text: str) -> None:
        try:
            async with asyncio.timeout(SEND_TIMEOUT_S):
                await self._socket.send_text(text)
        except TimeoutError as error:
            raise _TooSlowError from error
        except (WebSocketDisconnect, RuntimeError) as error:
            # RuntimeError: the server itself closed the connection just now, as for a message that
            # is too large, and the reader has not heard of it yet.
            raise _GoneError from error

    async def _close(self, code: int, reason: str) -> None:
        """Close; behind what a slow client has not taken yet there is no waiting for long."""
        try:
            async with asyncio.timeout(_CLOSE_TIMEOUT_S):
                await self._socket.close(code, reason)
        except (TimeoutError, WebSocketDisconnect, RuntimeError):
            log.debug("%s went without a goodbye", self._address)

    # --- reading ---------------------------------------------------------------------------------

    async def _read(self) -> None:
        """Take one message after the other; the next waits in the client until this one is done."""
        while True:
            message = await self._socket.receive()
            if message["type"] == "websocket.disconnect":
                raise _GoneError
            try:
                self._take(message)
            except PilothouseError as error:
                await self._send(self._hub.encoder.problem(error))
            # Messages that came together are all there at once: others get their turn in between.
            await asyncio.sleep(0)

    def _take(self, message: Mapping[str, Any]) -> None:
        supervisor = self._hub.supervisor
        given = read_client_message(message)
        reading = given.reading(given.signal, supervisor.clock)
        supervisor.submit_readings([reading], given.source, f"websocket:{self._address}")
