"""What a flood sends, as data: a process of its own sends it (`tests.support.floods.sender`)."""

from dataclasses import dataclass

NUMBER = b"NUMBER"
HOST = b"Host: 127.0.0.1\r\n"


@dataclass(frozen=True, slots=True)
class Flood:
    """Connections that all do the same, and are opened again when the service closes them."""

    connections: int
    opening: bytes = b""
    """What each sends first; the answer's head is awaited before the rest is sent. `NUMBER` in it
    becomes 40 times the number of the connection, such as the id of an event."""
    again: bytes = b""
    """What is sent without end, as fast as it is taken; empty: nothing."""
    every_s: float = 0.0
    """Time between two times of `again`, s; 0: none."""
    reads: bool = True
    """Whether answers are read."""
    lasts_s: float = 0.0
    """After which time a connection is closed and opened again, s; 0: never."""


def websocket_handshake(path: str) -> bytes:
    """Return the handshake of a WebSocket client without a token."""
    return (
        b"GET " + path.encode() + b" HTTP/1.1\r\n" + HOST + b"Upgrade: websocket\r\n"
        b"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    )
