"""Uvicorn's WebSocket protocol, extended for many clients that get the same frames at 20 Hz.

It differs from `WebSocketsSansIOProtocol` in three ways:

* The scope holds the connection, so that prepared frames can be written to its transport, and a
  listener can be set (`api.streaming.websocket_frames`).
* The answer to a ping is recognised without the parser, which takes ten times as long.
* A closed connection is aborted after 1 s. `transport.close()` alone waits until everything was
  sent; a client that does not read would keep its buffers forever.
"""

import asyncio
from typing import cast

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Frame, Opcode

from api.streaming.websocket_frames import EXTENSION, Connection, Listener

_LAST_WORDS_S = 1.0
_PONG_HEAD = bytes((0x80 | Opcode.PONG, 0x80 | 4))
"""Final, masked as all that clients send, and four bytes long as our pings are."""
_PONG_BYTES = 10


class WebSocketProtocol(WebSocketsSansIOProtocol):
    """One connection."""

    _listener: Listener | None = None
    _between_frames = False
    """Whether the next data certainly starts with a frame."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take over a connection; any data that cannot be sent at once is reported."""
        super().connection_made(transport)
        cast("asyncio.WriteTransport", transport).set_write_buffer_limits(high=0)

    async def run_asgi(self) -> None:
        """Let the application serve this client, then make sure that the connection ends."""
        connection = Connection(self.transport, self._listen)
        self.scope.setdefault("extensions", {})[EXTENSION] = {"connection": connection}
        await super().run_asgi()
        self.loop.call_later(_LAST_WORDS_S, self.transport.abort)

    def shutdown(self) -> None:
        """Close, since the service ends: with code 1012, or 503 before the handshake is done."""
        if not self.handshake_complete and self.handshake_initiated:
            self.conn.send_response(self.conn.reject(503, "the service is shutting down\n"))
            self.transport.write(b"".join(self.conn.data_to_send()))
            self.handshake_complete = self.close_sent = True
        super().shutdown()

    def pause_writing(self) -> None:
        """Notify the listener that not all data could be sent."""
        super().pause_writing()
        if self._listener is not None:
            self._listener.clogged()

    def connection_lost(self, exc: Exception | None) -> None:
        """Tell that the client is gone."""
        if self._listener is not None:
            self._listener.lost()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what the client sent."""
        if self._between_frames and len(data) == _PONG_BYTES and data.startswith(_PONG_HEAD):
            self._tell_answered()
            return
        # The first is the handshake, and ends where the frames begin.
        first = not self.handshake_initiated
        self._between_frames = first or (self._between_frames and _holds_whole_frames(data))
        super().data_received(data)

    def handle_pong(self, event: Frame) -> None:
        """Handle an answer to a ping that came together with other data."""
        self._tell_answered()

    def _tell_answered(self) -> None:
        if self._listener is not None:
            self._listener.answered()

    def _listen(self, listener: Listener | None) -> None:
        self._listener = listener


def _holds_whole_frames(data: bytes) -> bool:
    """Tell whether data that begins with a frame ends with one (RFC 6455, 5.2)."""
    at = 0
    while at + 2 <= len(data):
        length = data[at + 1] & 0x7F
        extra = {126: 2, 127: 8}.get(length, 0)
        if extra:
            length = int.from_bytes(data[at + 2 : at + 2 + extra])
        masked = 4 if data[at + 1] & 0x80 else 0
        at += 2 + extra + masked + length
    return at == len(data)
