"""How bytes of WebSocket frames, made once for all clients, reach a connection.

Frames of a server are not masked (RFC 6455, 5.1), so that without compression the bytes are the
same for all clients. ASGI knows only messages, each of which would be framed anew for each client,
by a coroutine of its own. So the server offers an extension in the scope of a WebSocket: the
transport of the connection, as `scope["extensions"][EXTENSION]["transport"]`. Nothing else of ASGI
changes; messages and prepared frames may follow each other in any order.
"""

import asyncio

from starlette.types import Scope
from websockets.frames import Frame, Opcode

EXTENSION = "pilothouse.frames"

KEEPALIVE_TIMEOUT = 1011
"""Code of a `websocket.disconnect` when the client did not answer a ping in time, and so does not
read."""


def transport_of(scope: Scope) -> asyncio.WriteTransport:
    """Return the connection of a client; to be written to once the client is accepted.

    Raises:
        LookupError: The server does not offer it.
    """
    extensions = scope.get("extensions", {})
    if EXTENSION not in extensions:
        raise LookupError(f"the server has no ASGI extension {EXTENSION!r}")
    transport: asyncio.WriteTransport = extensions[EXTENSION]["transport"]
    return transport


def text_frame(text: str) -> bytes:
    """Return a text as the bytes of one WebSocket frame."""
    return Frame(Opcode.TEXT, text.encode()).serialize(mask=False)
