"""One WebSocket client, reduced to what it takes to read frames and to answer pings."""

import socket

from tests.support.fan_out.arrivals import Arrivals

_READ_BYTES = 16_384
_TEXT, _CLOSE, _PING = 0x81, 0x88, 0x89
_LENGTH_16, _LENGTH_64 = 126, 127
_PATIENCE_S = 10.0


class LoadSocket:
    """A connection that is read when there is something to read.

    Args:
        address: Of the server.
        path: Of the stream.
    """

    def __init__(self, address: tuple[str, int], path: str) -> None:
        self._socket = socket.create_connection(address, _PATIENCE_S)
        self.fileno = self._socket.fileno()
        self.port: int = self._socket.getsockname()[1]
        self.is_open = False
        """Whether the server has accepted it."""
        self.seq: int | None = None
        """Of the newest frame."""
        self._rest = b""
        host, port = address
        self._socket.sendall(
            f"GET {path} HTTP/1.1\r\nHost: {host}:{port}\r\nConnection: Upgrade\r\n"
            "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
        )
        self._socket.setblocking(False)

    def read(self, arrivals: Arrivals) -> bool:
        """Take what has come; tell whether the connection goes on."""
        try:
            data = self._socket.recv(_READ_BYTES)
        except BlockingIOError:
            return True
        except OSError:
            return False
        if not data:
            return False
        arrivals.come()
        # Nearly always exactly one frame: then nothing is copied but its beginning.
        if (
            not self._rest
            and self.is_open
            and data[0] == _TEXT
            and data[1] == _LENGTH_16
            and len(data) == 4 + (data[2] << 8 | data[3])
        ):
            self.seq = arrivals.note(data, 4, self.seq)
            return True
        self._rest += data
        return (self.is_open or self._take_handshake()) and self._take_frames(arrivals)

    def close(self) -> None:
        """Close it."""
        self._socket.close()

    def _take_handshake(self) -> bool:
        """Take the answer to the handshake, if it is complete; tell whether it is no refusal."""
        head, end, rest = self._rest.partition(b"\r\n\r\n")
        if end:
            self._rest = rest
            self.is_open = head.startswith(b"HTTP/1.1 101")
        return self.is_open or not end

    def _take_frames(self, arrivals: Arrivals) -> bool:
        """Take all complete frames; tell whether none of them closes the connection."""
        if not self.is_open:
            return True
        data, at = self._rest, 0
        while len(data) - at >= 2:
            begin, size = at + 2, data[at + 1]
            if size == _LENGTH_16:
                begin, size = at + 4, int.from_bytes(data[at + 2 : at + 4])
            elif size == _LENGTH_64:
                begin, size = at + 10, int.from_bytes(data[at + 2 : at + 10])
            if len(data) < begin + size:
                break
            if data[at] == _TEXT:
                self.seq = arrivals.note(data[at : begin + size], begin - at, self.seq)
            elif data[at] == _PING:
                # A mask of zeros: the payload goes as it came.
                payload = data[begin : begin + size]
                self._socket.send(bytes((0x8A, 0x80 | size, 0, 0, 0, 0)) + payload)
            elif data[at] == _CLOSE:
                return False
            at = begin + size
        self._rest = data[at:]
        return True
