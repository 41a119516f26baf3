"""Uvicorn's WebSocket protocol, extended for many clients that get the same frames at 20 Hz.

It differs from `WebSocketsSansIOProtocol` in these ways:

* The scope holds the connection, so that prepared frames can be written to its transport, and a
  listener can be set (`api.streaming.websocket_frames`).
* The answer to a ping is recognised without the parser, which takes ten times as long.
* A closed connection is aborted after 1 s. `transport.close()` alone waits until everything was
  sent; a client that does not read would keep its buffers forever.
* It takes what arrives in pieces of few frames. Until the application has let a client in, that may
  send one short message, and no other frames. A message has a limited number of fragments.
* Pings of a client that does not read are not answered: the answers would fill its buffer.
"""

import asyncio
from typing import Any, cast

from uvicorn.config import Config
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from uvicorn.server import ServerState
from websockets.frames import Frame, Opcode

from api.serving.closings import Closings
from api.serving.frame_pieces import FramePieces
from api.serving.intake import Dispensable
from api.serving.pieces import Piece
from api.streaming.websocket_frames import EXTENSION, Connection, Listener

MAX_FIRST_BYTES = 4_096
"""Of the message with the token."""
MAX_FRAGMENTS = 1_000
"""Of one message; empty ones would cost memory without ever reaching the limit of its size."""
MAX_UNSENT_BYTES = 65_536
"""Unsent data, above which pings are not answered."""
_POLICY_VIOLATION = 1008
_INVALID_DATA = 1007
_LAST_WORDS_S = 1.0
_PONG_HEAD = bytes((0x80 | Opcode.PONG, 0x80 | 4))
"""Final, masked as all that clients send, and four bytes long as our pings are."""
_PONG_BYTES = 10


class WebSocketProtocol(WebSocketsSansIOProtocol):
    """One connection."""

    _listener: Listener | None = None
    _between_frames = False
    """Whether the next data certainly starts with a frame."""
    _is_let_in = False
    _last_words: asyncio.TimerHandle | None = None
    in_message = False

    def __init__(
        self,
        config: Config,
        server_state: ServerState,
        app_state: dict[str, Any],
        closings: Closings | None = None,
    ) -> None:
        """Prepare; all but `closings`, which counts expelled clients, is uvicorn's."""
        super().__init__(config, server_state, app_state)
        self._closings = closings or Closings()
        self._pieces = FramePieces()

    @property
    def dispensable(self) -> Dispensable:
        """Return whether it may be closed for a new one."""
        return Dispensable.NOT if self._is_let_in else Dispensable.AT_ONCE

    def overdue(self, now: float) -> str | None:
        """Return None: the application has deadlines for its clients."""
        return None

    def next_piece(self, waiting: bytearray) -> Piece:
        """Return the next frames."""
        return self._pieces.next(waiting)

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take over a connection; any data that cannot be sent at once is reported."""
        super().connection_made(transport)
        cast("asyncio.WriteTransport", transport).set_write_buffer_limits(high=0)

    async def run_asgi(self) -> None:
        """Let the application serve this client, then make sure that the connection ends."""
        connection = Connection(self.transport, self._listen, self._let_in)
        self.scope.setdefault("extensions", {})[EXTENSION] = {"connection": connection}
        await super().run_asgi()
        # It refers to this protocol, as that refers to it.
        cast("dict[str, Any]", self.scope).clear()
        if not self.disconnected:
            self._last_words = self.loop.call_later(_LAST_WORDS_S, self.transport.abort)

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
        # What refers to this protocol, or to itself, would keep it until a garbage collection.
        if self._last_words is not None:
            self._last_words.cancel()
        self.conn.parser.close()
        self.conn.parser_exc = None

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
        if not self._is_let_in:
            self._expel(_POLICY_VIOLATION)
        self._tell_answered()

    def handle_ping(self) -> None:
        """Answer a ping, if the client reads."""
        if not self._is_let_in:
            self._expel(_POLICY_VIOLATION)
        elif self.transport.get_write_buffer_size() > MAX_UNSENT_BYTES:
            self.conn.data_to_send()
        else:
            super().handle_ping()

    def handle_text(self, event: Frame) -> None:
        """Take a text, or the first part of one."""
        if self._may_say(event):
            super().handle_text(event)

    def handle_bytes(self, event: Frame) -> None:
        """Take bytes, or the first part of them."""
        if self._may_say(event):
            super().handle_bytes(event)

    def handle_cont(self, event: Frame) -> None:
        """Take a further part of a message."""
        if len(self.frames) >= MAX_FRAGMENTS:
            self._expel(_POLICY_VIOLATION)
        elif self._may_say(event):
            super().handle_cont(event)

    def send_receive_event_to_app(self) -> None:
        """Hand a message on, if it is text or bytes as it says."""
        if self.curr_msg_data_type == "text":
            try:
                b"".join(self.frames).decode()
            except UnicodeDecodeError:
                self._expel(_INVALID_DATA)
                return
        super().send_receive_event_to_app()

    def _may_say(self, event: Frame) -> bool:
        """Tell whether a client may send this; one without a token says little, and in one go."""
        if self._is_let_in or (event.fin and 0 < len(event.data) <= MAX_FIRST_BYTES):
            return True
        self._expel(_POLICY_VIOLATION)
        return False

    def _expel(self, code: int) -> None:
        """Close because of what the client sent."""
        if self.transport.is_closing():
            return
        address = self.client[0] if self.client else "unknown"
        self._closings.note("frames", address)
        self.queue.put_nowait({"type": "websocket.disconnect", "code": code, "reason": ""})
        if self.handshake_complete and not self.close_sent:
            self.conn.send_close(code)
            self.transport.write(b"".join(self.conn.data_to_send()))
        self.close_sent = True
        self.transport.close()

    def _tell_answered(self) -> None:
        if self._listener is not None:
            self._listener.answered()

    def _let_in(self) -> None:
        self._is_let_in = True

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
