"""Sends what takes long in a thread of its own, so that the event loop does not wait.

To cut a message of a megabyte into pieces, and to wait for room for them, takes up to 50 ms; a
short message takes a few microseconds on the event loop, and in a thread would wait for the
interpreter.
"""

import threading
from collections import Counter
from collections.abc import Callable
from queue import SimpleQueue

from domain.computers import ComputerName
from service.link.port import MAX_BYTES_PER_S

LONG_BYTES = 16_384
"""From which length on a message is sent by the thread."""


class LongMessages:
    """The thread, and what waits for it.

    Args:
        put: Sends a message; called on the thread.
    """

    def __init__(self, put: Callable[[ComputerName, bytes], object]) -> None:
        self._put = put
        self._lock = threading.Lock()
        self._waiting: Counter[ComputerName] = Counter()
        """Messages for each computer."""
        self._waiting_bytes = 0
        self._work: SimpleQueue[tuple[ComputerName, bytes] | None] = SimpleQueue()
        # A daemon: a connection that blocks must not keep the process from ending.
        threading.Thread(target=self._send_all, name="long messages", daemon=True).start()

    def concern(self, to: ComputerName, message: bytes) -> bool:
        """Tell whether a message has to be sent here: it is long, or comes behind one for `to`."""
        if len(message) >= LONG_BYTES:
            return True
        with self._lock:
            return self._waiting[to] > 0

    def send(self, to: ComputerName, message: bytes) -> bool:
        """Send a message soon; False: too much waits, and the message is dropped."""
        with self._lock:
            if self._waiting_bytes + len(message) > MAX_BYTES_PER_S:
                return False
            self._waiting[to] += 1
            self._waiting_bytes += len(message)
        self._work.put((to, message))
        return True

    def end(self) -> None:
        """Let the thread end after what it was given."""
        self._work.put(None)

    def _send_all(self) -> None:
        while (work := self._work.get()) is not None:
            to, message = work
            self._put(to, message)
            with self._lock:
                self._waiting[to] -= 1
                self._waiting_bytes -= len(message)
