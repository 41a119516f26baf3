"""What the kernel still holds for a client: sent or to be sent, and not acknowledged."""

import asyncio
import struct

try:
    import fcntl
    import termios
except ImportError:  # There are none for Windows.
    fcntl = None  # type: ignore[assignment]
    termios = None  # type: ignore[assignment]


def unacknowledged_bytes(transport: asyncio.WriteTransport) -> int:
    """Return the bytes in the send buffer of the kernel; 0 where that is not known.

    While there are any, the client reads as fast as they become fewer.
    """
    connection = transport.get_extra_info("socket")
    if connection is None or fcntl is None or termios is None:
        return 0
    try:
        answer = fcntl.ioctl(connection.fileno(), termios.TIOCOUTQ, b"\0\0\0\0")
    except (OSError, ValueError):
        return 0
    (count,) = struct.unpack("i", answer)
    return int(count)
