import asyncio
import socket
import sys
from collections.abc import Iterator
from types import SimpleNamespace
from typing import cast

import pytest

from api.streaming.send_buffer import unacknowledged_bytes


@pytest.fixture
def connection() -> Iterator[tuple[socket.socket, socket.socket]]:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        ours = socket.create_connection(listener.getsockname())
        theirs, _ = listener.accept()
        with ours, theirs:
            yield ours, theirs


def transport_of(ours: socket.socket | None) -> asyncio.WriteTransport:
    return cast("asyncio.WriteTransport", SimpleNamespace(get_extra_info=lambda name: ours))


@pytest.mark.skipif(sys.platform != "linux", reason="asks the kernel of Linux")
def test_what_a_client_does_not_read_stays_unacknowledged(
    connection: tuple[socket.socket, socket.socket],
) -> None:
    ours, _ = connection
    ours.setblocking(False)
    sent = 0
    try:
        while True:
            sent += ours.send(bytes(65_536))
    except BlockingIOError:
        pass

    assert 0 < unacknowledged_bytes(transport_of(ours)) <= sent


def test_a_connection_without_a_socket_or_a_closed_one_counts_as_read(
    connection: tuple[socket.socket, socket.socket],
) -> None:
    ours, _ = connection
    ours.close()

    assert unacknowledged_bytes(transport_of(None)) == 0
    assert unacknowledged_bytes(transport_of(ours)) == 0
