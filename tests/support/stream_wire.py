"""The transport of a stream client, which a test can clog."""

import asyncio
import json
from typing import Any

from api.streaming.websocket_frames import PING, Connection, Listener
from tests.support.websocket import texts_of


class Wire(asyncio.WriteTransport):
    """Takes what is written while it flows; else keeps it. Answers pings unless told otherwise."""

    def __init__(self) -> None:
        super().__init__()
        self.written: list[bytes] = []
        self.waiting = 0
        self.flows = True
        self.answers = True
        self.closing = False
        self.listener: Listener | None = None

    @property
    def connection(self) -> Connection:
        """Return the connection of the client."""
        return Connection(self, self._listen, lambda: None)

    def write(self, data: Any) -> None:  # noqa: ANN401
        """Take data, or keep it while it does not flow."""
        assert not self.closing
        self.written.append(data)
        if not self.flows:
            self.waiting += len(data)
            if self.listener is not None:
                self.listener.clogged()
        elif data.endswith(PING) and self.answers and self.listener is not None:
            self.listener.answered()

    def get_write_buffer_size(self) -> int:
        """Return what is kept."""
        return self.waiting

    def is_closing(self) -> bool:
        """Tell whether it is closed."""
        return self.closing

    def abort(self) -> None:
        """Cut the client off."""
        self.closing = True
        if self.listener is not None:
            self.listener.lost()

    def close(self) -> None:
        """Cut the client off."""
        self.abort()

    def flow(self) -> None:
        """Let everything flow that was kept."""
        self.flows, self.waiting = True, 0

    @property
    def frames(self) -> list[dict[str, Any]]:
        """Return all that was written."""
        return [json.loads(text) for text in texts_of(b"".join(self.written))]

    def _listen(self, listener: Listener | None) -> None:
        self.listener = listener
