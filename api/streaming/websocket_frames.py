"""Sends the bytes of WebSocket frames, made once for all clients, on a connection.

Frames of a server are not masked (RFC 6455, section 5.1), so that without compression the bytes are
the same for all clients. ASGI has only messages, which are framed separately for each client, by
its own coroutine. So the server offers an extension in the scope of a WebSocket: a
`Connection`, as `scope["extensions"][EXTENSION]["connection"]`. Nothing else of ASGI changes;
messages and prepared frames may follow each other in any order.
"""

import asyncio
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from starlette.types import Scope
from websockets.frames import Frame, Opcode

EXTENSION = "pilothouse.frames"


class Listener(Protocol):
    """Is notified of events of a connection at once."""

    def clogged(self) -> None:
        """Handle that not all data could be sent; the rest waits in the transport."""
        ...

    def answered(self) -> None:
        """Handle that the client answered a ping, and so reads."""
        ...

    def lost(self) -> None:
        """Handle that nothing can be written any more."""
        ...


@dataclass(frozen=True, slots=True)
class Connection:
    """The connection of one client, as offered by the server."""

    transport: asyncio.WriteTransport
    """For whole frames, once the client is accepted."""
    listen: Callable[[Listener | None], None]
    """Sets the listener from now on; None: none."""
    let_in: Callable[[], None]
    """Tells that the client has shown that it has access, and may send whatever frames it likes."""


def connection_of(scope: Scope) -> Connection:
    """Return the connection of a client.

    Raises:
        LookupError: The server does not offer it.
    """
    extensions = scope.get("extensions", {})
    if EXTENSION not in extensions:
        raise LookupError(f"the server has no ASGI extension {EXTENSION!r}")
    connection: Connection = extensions[EXTENSION]["connection"]
    return connection


def text_frame(text: str | bytes) -> bytes:
    """Return a text, which may be UTF-8 already, as the bytes of one WebSocket frame."""
    data = text if isinstance(text, bytes) else text.encode()
    size = len(data)
    if size < _LENGTH_16:
        return bytes((_TEXT, size)) + data
    if size < _SIZES_OF_16:
        return _HEAD_16.pack(_TEXT, _LENGTH_16, size) + data
    return _HEAD_64.pack(_TEXT, _LENGTH_64, size) + data


_TEXT = 0x81
_LENGTH_16, _LENGTH_64 = 126, 127
_SIZES_OF_16 = 2**16
_HEAD_16, _HEAD_64 = struct.Struct("!BBH"), struct.Struct("!BBQ")

PING = Frame(Opcode.PING, b"ping").serialize(mask=False)
"""The bytes of a ping; the answer holds the same four."""
