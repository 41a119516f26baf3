"""Uvicorn's WebSocket protocol, extended where many clients get the same 20 times a second.

Three things differ from `WebSocketsSansIOProtocol`, and only these:

* The scope holds the transport, so that prepared frames can be written to it
  (`api.streaming.prepared`).
* The answer to a ping, which each client sends every other second, is recognised without the
  parser, which takes ten times as long.
* A connection that is ended, ends. `transport.close()` waits until everything was sent; to a client
  that does not read, that is never, and its buffers would stay.
"""

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Frame, Opcode

from api.streaming.prepared import EXTENSION, KEEPALIVE_TIMEOUT

_LAST_WORDS_S = 1.0
_PONG_HEAD = bytes((0x80 | Opcode.PONG, 0x80 | 4))
"""Final, masked as all that clients send, and four bytes long as our pings are."""
_PONG_BYTES = 10


class WebSocketProtocol(WebSocketsSansIOProtocol):
    """One connection."""

    _between_frames = False
    """Whether what comes next is surely the begin of a frame."""

    async def run_asgi(self) -> None:
        """Let the application serve this client, then see that the connection ends."""
        self.scope["extensions"][EXTENSION] = {"transport": self.transport}
        await super().run_asgi()
        self.loop.call_later(_LAST_WORDS_S, self.transport.abort)

    def keepalive_timeout(self) -> None:
        """Cut off a client that did not answer a ping, and tell the application why."""
        super().keepalive_timeout()
        self.queue.put_nowait({"type": "websocket.disconnect", "code": KEEPALIVE_TIMEOUT})
        self.transport.abort()

    def data_received(self, data: bytes) -> None:
        """Take what the client sent."""
        if self._between_frames and len(data) == _PONG_BYTES and data.startswith(_PONG_HEAD):
            mask, masked = int.from_bytes(data[2:6]), int.from_bytes(data[6:])
            self.handle_pong(Frame(Opcode.PONG, (mask ^ masked).to_bytes(4)))
            return
        # The first is the handshake, and ends where the frames begin.
        first = not self.handshake_initiated
        self._between_frames = first or (self._between_frames and _holds_whole_frames(data))
        super().data_received(data)


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
