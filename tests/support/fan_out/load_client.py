"""Many WebSocket clients in one process, cheap enough not to be what is measured.

`python -m tests.support.fan_out.load_client HOST:PORT PATH` reads commands from its input, a line
of JSON each, and answers each with a line of JSON; `tests/support/fan_out/load.py` is who speaks to
it. Sockets are read by epoll at all times, also while further clients connect. It answers pings.
"""

import gc
import json
import os
import select
import sys
import time
from collections.abc import Callable
from typing import Any

from tests.support.fan_out.arrivals import Arrivals
from tests.support.fan_out.load_socket import LoadSocket

_CONNECTING_AT_ONCE = 50
_CONNECTED_WITHIN_S = 20.0


class LoadClient:
    """Clients of one address, and what comes to them.

    Args:
        address: Of the server, with its port.
        path: Of the stream.
    """

    def __init__(self, address: str, path: str) -> None:
        host, _, port = address.rpartition(":")
        self._address = (host, int(port))
        self._path = path
        self._epoll = select.epoll()
        self._sockets: dict[int, LoadSocket] = {}
        self._arrivals = Arrivals()
        self._ended = 0
        self._epoll.register(sys.stdin.fileno(), select.EPOLLIN)

    def run(self) -> None:
        """Obey until the input ends."""
        commands: dict[str, Callable[..., dict[str, Any]]] = {
            "connect": self._connect,
            "begin": self._begin,
            "end": self._end,
            "stop_reading": self._stop_reading,
        }
        waiting = b""
        while True:
            while not self._turn(1.0):
                pass
            chunk = os.read(sys.stdin.fileno(), 4096)
            if not chunk:
                return
            *lines, waiting = (waiting + chunk).split(b"\n")
            for line in lines:
                name, *arguments = json.loads(line)
                print(json.dumps(commands[name](*arguments)), flush=True)

    def _turn(self, timeout_s: float) -> bool:
        """Read what has come; tell whether a command waits."""
        commanded = False
        for number, _ in self._epoll.poll(timeout_s):
            if number == sys.stdin.fileno():
                commanded = True
            elif not self._sockets[number].read(self._arrivals):
                self._epoll.unregister(number)
                self._sockets.pop(number).close()
                self._ended += 1
        return commanded

    def _connect(self, count: int) -> dict[str, Any]:
        """Connect until there are so many, or the server refuses, or it takes too long."""
        begin = time.perf_counter()
        refused = self._ended
        pending: list[LoadSocket] = []
        while time.perf_counter() < begin + _CONNECTED_WITHIN_S and self._ended == refused:
            pending = [socket for socket in pending if not socket.is_open]
            while len(self._sockets) < count and len(pending) < _CONNECTING_AT_ONCE:
                socket = LoadSocket(self._address, self._path)
                pending.append(socket)
                self._sockets[socket.fileno] = socket
                self._epoll.register(socket.fileno, select.EPOLLIN)
            if not pending:
                break
            self._turn(0.01)
        return {"connected": sum(socket.is_open for socket in self._sockets.values())}

    def _begin(self) -> dict[str, Any]:
        """Begin to note what arrives."""
        self._arrivals.begin()
        return {}

    def _end(self) -> dict[str, Any]:
        """Tell what arrived since the begin."""
        return {**self._arrivals.end(), "ended": self._ended}

    def _stop_reading(self) -> dict[str, Any]:
        """Let one client read no more; return the port by which the server knows it."""
        number, socket = next(iter(self._sockets.items()))
        # It stays among the sockets, or it would be closed.
        self._epoll.unregister(number)
        return {"port": socket.port}


if __name__ == "__main__":
    # Nothing here makes a cycle, and a collection would look like a late frame.
    gc.disable()
    LoadClient(sys.argv[1], sys.argv[2]).run()
