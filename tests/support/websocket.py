"""A WebSocket client of an ASGI application without a network, for tests in virtual time."""

import asyncio
import json
from collections.abc import MutableMapping
from contextlib import suppress
from types import TracebackType
from typing import Any, Self
from urllib.parse import urlencode

from starlette.types import ASGIApp

Message = MutableMapping[str, Any]


class WebSocketClient:
    """Speaks to one route, and keeps what it is sent until it is read.

    Args:
        app: The application.
        query: Of the address.
        path: Of the address.
    """

    def __init__(self, app: ASGIApp, path: str = "/ws", **query: object) -> None:
        self.closed: int | None = None
        """Code with which the server closed; None: it did not."""
        self._app = app
        self._scope = {
            "type": "websocket",
            "asgi": {"version": "3.0", "spec_version": "2.4"},
            "http_version": "1.1",
            "scheme": "ws",
            "path": path,
            "raw_path": path.encode(),
            "root_path": "",
            "query_string": urlencode(query).encode(),
            "headers": [(b"host", b"127.0.0.1:8000")],
            "client": ("127.0.0.1", 40_000),
            "server": ("127.0.0.1", 8000),
            "subprotocols": [],
            "state": {},
            "extensions": {},
        }
        self._to_app: asyncio.Queue[Message] = asyncio.Queue()
        self._from_app: asyncio.Queue[Message] = asyncio.Queue()
        self._reads = asyncio.Event()
        self._reads.set()

    async def __aenter__(self) -> Self:
        """Connect."""
        self._to_app.put_nowait({"type": "websocket.connect"})
        self.running = asyncio.create_task(self._run(), name="websocket application")
        accepted = await self._from_app.get()
        if accepted["type"] != "websocket.accept":
            raise ConnectionRefusedError(accepted)
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Go, and wait until the application has noticed."""
        self._reads.set()
        self.leave()
        with suppress(TimeoutError):
            await asyncio.wait_for(self.running, 5)

    def leave(self, code: int = 1000) -> None:
        """Close from this side."""
        self._to_app.put_nowait({"type": "websocket.disconnect", "code": code})

    def stop_reading(self) -> None:
        """Let whatever the application sends from now on wait for ever."""
        self._reads.clear()

    def go_on_reading(self) -> None:
        """Take what waits."""
        self._reads.set()

    def send(self, message: object) -> None:
        """Send a message as JSON."""
        self.send_text(json.dumps(message))

    def send_text(self, text: str) -> None:
        """Send a text message."""
        self._to_app.put_nowait({"type": "websocket.receive", "text": text})

    def send_bytes(self, content: bytes) -> None:
        """Send a binary message."""
        self._to_app.put_nowait({"type": "websocket.receive", "bytes": content})

    async def text(self) -> str:
        """Return the next frame as it came."""
        message = await asyncio.wait_for(self._from_app.get(), 5)
        if message["type"] == "websocket.close":
            raise ConnectionResetError(f"closed with {message.get('code')}")
        text = message["text"]
        assert isinstance(text, str)
        return text

    async def frame(self, kind: str | None = None) -> dict[str, Any]:
        """Return the next frame, or the next of a kind."""
        while True:
            frame: dict[str, Any] = json.loads(await self.text())
            if kind is None or frame["type"] == kind:
                return frame

    def frames(self) -> list[dict[str, Any]]:
        """Return the frames that are there now."""
        found = []
        while not self._from_app.empty():
            message = self._from_app.get_nowait()
            if message["type"] == "websocket.send":
                found.append(json.loads(message["text"]))
        return found

    async def end(self) -> int | None:
        """Wait until the application has ended; return the code with which it closed."""
        await asyncio.wait_for(self.running, 5)
        return self.closed

    async def _run(self) -> None:
        await self._app(self._scope, self._to_app.get, self._take)

    async def _take(self, message: Message) -> None:
        await self._reads.wait()
        if message["type"] == "websocket.close":
            self.closed = message.get("code")
        self._from_app.put_nowait(message)
