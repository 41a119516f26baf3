"""A WebSocket client of an ASGI application without a network, for tests in virtual time."""

import asyncio
import json
import struct
from collections.abc import Iterator, Mapping, MutableMapping
from contextlib import suppress
from types import TracebackType
from typing import Any, Self
from urllib.parse import urlencode

from starlette.types import ASGIApp

from api.streaming.websocket_frames import EXTENSION, PING, Connection, Listener

Message = MutableMapping[str, Any]


class WebSocketClient(asyncio.WriteTransport):
    """Speaks to one route, and keeps what it is sent until it is read.

    It is its own transport, for frames made once (`api.streaming.websocket_frames`), and answers
    pings as long as it reads.

    Args:
        app: The application.
        path: Of the address.
        headers: Of the handshake, beside `Host`.
        query: Of the address.
    """

    def __init__(
        self,
        app: ASGIApp,
        path: str = "/ws",
        headers: Mapping[str, str] | None = None,
        **query: object,
    ) -> None:
        super().__init__()
        self.closed: int | None = None
        """Code with which the server closed; None: it did not."""
        self.cut_off = False
        """Whether the application cut this client off without a goodbye."""
        self._waiting: list[bytes] = []
        self._listener: Listener | None = None
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
            "headers": [
                (name.encode(), value.encode())
                for name, value in {"host": "127.0.0.1:8000", **(headers or {})}.items()
            ],
            "client": ("127.0.0.1", 40_000),
            "server": ("127.0.0.1", 8000),
            "subprotocols": [],
            "state": {},
            "extensions": {EXTENSION: {"connection": Connection(self, self._listen, lambda: None)}},
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
        for frames in self._waiting:
            self._read_frames(frames)
        self._waiting.clear()

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

    def write(self, data: bytes | bytearray | memoryview) -> None:
        """Take whole WebSocket frames, as the transport of this client."""
        if self._reads.is_set():
            self._read_frames(bytes(data))
            return
        self._waiting.append(bytes(data))
        if self._listener is not None:
            self._listener.clogged()

    def get_write_buffer_size(self) -> int:
        """Return the bytes that this client has not read."""
        return sum(map(len, self._waiting))

    def is_closing(self) -> bool:
        """Tell whether nothing can be sent to this client any more."""
        return self.cut_off or self.closed is not None

    def close(self) -> None:
        self.abort()

    def abort(self) -> None:
        """Cut this client off."""
        self.cut_off = True
        self._waiting.clear()
        self._to_app.put_nowait({"type": "websocket.disconnect", "code": 1006})
        if self._listener is not None:
            self._listener.lost()

    def _listen(self, listener: Listener | None) -> None:
        self._listener = listener

    def _read_frames(self, frames: bytes) -> None:
        if frames.endswith(PING) and self._listener is not None:
            self._listener.answered()
        for text in texts_of(frames):
            self._from_app.put_nowait({"type": "websocket.send", "text": text})

    async def _run(self) -> None:
        await self._app(self._scope, self._to_app.get, self._take)

    async def _take(self, message: Message) -> None:
        await self._reads.wait()
        if message["type"] == "websocket.close":
            self.closed = message.get("code")
        self._from_app.put_nowait(message)


def texts_of(frames: bytes) -> Iterator[str]:
    """Yield the texts of whole WebSocket frames from a server (RFC 6455, 5.2), without pings."""
    while frames:
        head, length = 2, frames[1]
        if length == 126:
            head, (length,) = 4, struct.unpack("!H", frames[2:4])
        elif length == 127:
            head, (length,) = 10, struct.unpack("!Q", frames[2:10])
        end = head + length
        assert len(frames) >= end
        assert frames[0] == 0x81 or frames[:end] == PING, "a final frame of text, or a ping"
        if frames[0] == 0x81:
            yield frames[head:end].decode()
        frames = frames[end:]
