"""Connections without a network, whose turns are counted instead of timed."""

import asyncio
from collections.abc import Callable
from typing import Any, cast

import uvicorn
from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.server import ServerState

from api.serving.closings import Closings
from api.serving.connections import Connections
from api.serving.http_protocol import HttpProtocol, urgency_of
from api.serving.intake import READ_BYTES, Intake
from api.serving.turns import Turns
from api.serving.websocket_protocol import WebSocketProtocol


class CountedLoop:
    """Calls what it is given in the next turn."""

    def __init__(self) -> None:
        self._soon: list[Callable[[], None]] = []

    def call_soon(self, function: Callable[[], None]) -> None:
        """Call a function in the next turn."""
        self._soon.append(function)

    def turn(self) -> None:
        """Run one turn."""
        soon, self._soon = self._soon, []
        for function in soon:
            function()

    @property
    def is_idle(self) -> bool:
        """Tell whether nothing is to be called."""
        return not self._soon


class RawTransport(asyncio.Transport):
    """Keeps what is written, and reads what a client has sent while it may."""

    def __init__(self) -> None:
        super().__init__({"peername": ("192.0.2.1", 1234), "sockname": ("127.0.0.1", 8000)})
        self.written = bytearray()
        self.unsent = 0
        self.reads = True
        self.aborted = False
        self._closing = False

    def write(self, data: bytes | bytearray | memoryview) -> None:
        """Keep what is written."""
        self.written += data

    def pause_reading(self) -> None:
        """Read nothing more."""
        self.reads = False

    def resume_reading(self) -> None:
        """Read again."""
        self.reads = True

    def is_closing(self) -> bool:
        """Tell whether it was closed."""
        return self._closing

    def close(self) -> None:
        """Close."""
        self._closing = True

    def abort(self) -> None:
        """Close at once."""
        self._closing = self.aborted = True

    def get_write_buffer_size(self) -> int:
        """Return how many bytes wait."""
        return self.unsent

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        """Take the limits, and do nothing with them."""


async def answer(scope: Scope, receive: Receive, send: Send) -> None:
    """Answer each request with 200, and let each WebSocket client in."""
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.accept"})
        scope["extensions"]["pilothouse.frames"]["connection"].let_in()
        while (await receive())["type"] != "websocket.disconnect":
            pass
        return
    headers = [(b"content-length", b"2")]
    await send({"type": "http.response.start", "status": 200, "headers": headers})
    await send({"type": "http.response.body", "body": b"ok"})


class _CountedProtocol(HttpProtocol):
    """Notes the bytes of each piece."""

    handed_on: list[int]

    def data_received(self, data: bytes) -> None:
        self.handed_on.append(len(data))
        super().data_received(data)


class _CountedWebSocket(WebSocketProtocol):
    """Notes the bytes of each piece."""

    handed_on: list[int]

    def data_received(self, data: bytes) -> None:
        self.handed_on.append(len(data))
        super().data_received(data)


class FloodedService:
    """The layers between network and application.

    Args:
        most: Connections at the same time.
        app: The application.
        turns: Of the connections; None: those of `loop`, whose turns the test runs itself.
    """

    def __init__(
        self, most: int = 1_000, app: ASGIApp = answer, turns: Turns | None = None
    ) -> None:
        self.loop = CountedLoop()
        self.closings = Closings()
        self.connections = Connections(most, self.closings)
        self.state = ServerState()
        self._turns = turns or Turns(self.loop.call_soon)
        self._config = uvicorn.Config(
            app,
            ws=cast("type[WebSocketProtocol]", self._make_socket),
            ws_per_message_deflate=False,
            ws_ping_interval=None,
            interface="asgi3",
            log_config=None,
            access_log=False,
        )
        self._config.load()
        self.handed_on: list[int] = []
        """Bytes of each piece, in order."""

    def connect(self) -> "Client":
        """Return a new client."""
        return Client(self.make(), self)

    def _make_socket(self, **options: Any) -> WebSocketProtocol:  # noqa: ANN401
        socket = _CountedWebSocket(**options, closings=self.closings)
        socket.handed_on = self.handed_on
        return socket

    def make(self) -> Intake:
        inner = _CountedProtocol(self._config, self.state, {}, self.closings)
        inner.handed_on = self.handed_on
        return Intake(inner, self._turns, self.connections, urgency_of)


class Client:
    """One client, whose kernel keeps what the service does not read."""

    def __init__(self, intake: Intake, service: FloodedService) -> None:
        self.intake = intake
        self.raw = RawTransport()
        self.unread = bytearray()
        intake.connection_made(self.raw)

    def send(self, data: bytes) -> None:
        """Send, and let the service read what it wants of it."""
        self.unread += data
        self.deliver()

    def deliver(self) -> None:
        """Let the service read once."""
        if self.unread and self.raw.reads and not self.raw.is_closing():
            part = self.unread[:READ_BYTES]
            del self.unread[:READ_BYTES]
            self.intake.get_buffer(-1)[: len(part)] = part
            self.intake.buffer_updated(len(part))

    def lose(self) -> None:
        """End the connection."""
        self.raw.abort()
        self.intake.connection_lost(ConnectionResetError())
