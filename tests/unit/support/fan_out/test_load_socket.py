import socket
import struct
from collections.abc import Iterator

import pytest

from tests.support.fan_out.arrivals import Arrivals
from tests.support.fan_out.control import frame
from tests.support.fan_out.load_socket import LoadSocket

ACCEPTED = b"HTTP/1.1 101 Switching Protocols\r\n\r\n"


class Server:
    """The other end of one client, byte for byte."""

    def __init__(self, listener: socket.socket) -> None:
        self.arrivals = Arrivals()
        self.client = LoadSocket(listener.getsockname(), "/ws")
        self._connection, _ = listener.accept()
        self._connection.settimeout(5)
        self.request = self._connection.recv(1000)

    def send(self, data: bytes) -> bool:
        """Send, and let the client read; tell whether the connection goes on."""
        self._connection.sendall(data)
        return self.client.read(self.arrivals)

    def receive(self) -> bytes:
        return self._connection.recv(1000)

    def close(self) -> None:
        self.client.close()
        self._connection.close()


@pytest.fixture
def server() -> Iterator[Server]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        server = Server(listener)
        yield server
        server.close()


def _state(number: int, size: int = 200) -> bytes:
    return struct.pack(">BBH", 0x81, 126, size) + frame(number, size).encode()


def test_a_client_is_open_once_its_handshake_is_answered(server: Server) -> None:
    assert server.request.startswith(b"GET /ws HTTP/1.1\r\n")

    assert server.send(ACCEPTED[:20])
    assert not server.client.is_open
    assert server.send(ACCEPTED[20:])
    assert server.client.is_open


def test_a_refused_client_is_at_its_end(server: Server) -> None:
    assert not server.send(b"HTTP/1.1 403 Forbidden\r\n\r\n")


def test_a_frame_is_counted_whole_in_pieces_and_behind_another_one(server: Server) -> None:
    server.send(ACCEPTED + _state(1))
    server.arrivals.begin()

    server.send(_state(2))
    server.send(_state(3)[:50])
    server.send(_state(3)[50:])
    server.send(_state(4) + _state(5))

    found = server.arrivals.end()
    assert (found["frames"], found["lost"], found["frame_bytes"]) == (4, 0, 200)


def test_a_frame_that_does_not_come_is_lost(server: Server) -> None:
    server.send(ACCEPTED + _state(1))
    server.arrivals.begin()

    server.send(_state(4))

    assert server.arrivals.end()["lost"] == 2


def test_what_has_no_number_is_no_frame(server: Server) -> None:
    server.arrivals.begin()

    server.send(ACCEPTED + b'\x81\x10{"type":"hello"}')

    assert server.arrivals.end()["frames"] == 0


def test_a_ping_is_answered_with_what_it_holds(server: Server) -> None:
    assert server.send(ACCEPTED + b"\x89\x02hi")

    assert server.receive() == b"\x8a\x82\0\0\0\0hi"


def test_a_closing_frame_is_the_end(server: Server) -> None:
    assert not server.send(ACCEPTED + b"\x88\x02\x03\xe8")
