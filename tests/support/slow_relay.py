"""A relay of UDP that delays packets, and lets later ones overtake earlier ones.

No kernel here has netem, so a slow network is a thread that keeps each packet for a while. QUIC
takes it for the network: each packet of it is a datagram.
"""

import heapq
import random
import select
import socket
import threading
import time
from itertools import count
from typing import NamedTuple, Self, TypeAlias

Address: TypeAlias = tuple[str, int]

_LONGEST = 65_536
_MAX_WAITING = 20_000
"""Packets under way at most; of more, the newest is lost, as in a router."""


class _Waiting(NamedTuple):
    due_s: float
    number: int
    through: socket.socket
    to: Address
    data: bytes


class SlowRelay:
    """Stands between two ends of a connection, as long as the context lasts.

    Args:
        at: Where clients find it.
        target: Where they would find the server without it.
        shortest_s: What each packet is delayed by at least, in each direction.
        longest_s: And at most; each has a delay of its own, so that they overtake each other.
    """

    def __init__(self, at: Address, target: Address, shortest_s: float, longest_s: float) -> None:
        self.overtaken = 0
        """Packets that arrived later than one that was sent after them."""
        self.carried = 0
        self.port = at[1]
        self._target = target
        self._delay_s = shortest_s, longest_s
        self._random = random.Random(1)
        self._numbers = count()
        self._waiting: list[_Waiting] = []
        self._newest: dict[Address, int] = {}
        self._front = _bound(at)
        self._behind: dict[socket.socket, Address] = {}
        """By the socket of its own that a client has towards the server."""
        self._of_client: dict[Address, socket.socket] = {}
        self._keeps = threading.Event()
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._carry, name="slow relay")

    def keep(self) -> None:
        """Let nothing pass; what comes meanwhile is delivered after `let_pass`."""
        self._keeps.set()

    def let_pass(self) -> None:
        """Deliver what was kept, and let all pass again."""
        self._keeps.clear()

    def __enter__(self) -> Self:
        """Begin to carry packets."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Carry none any more."""
        self._ends.set()
        self._thread.join()
        for each in (self._front, *self._behind):
            each.close()

    def _carry(self) -> None:
        while not self._ends.is_set():
            left_s = self._waiting[0].due_s - time.monotonic() if self._waiting else 0.01
            ready, _, _ = select.select([self._front, *self._behind], [], [], _within(left_s))
            for each in ready:
                self._take(each)
            if not self._keeps.is_set():
                self._deliver(time.monotonic())

    def _take(self, arrived_at: socket.socket) -> None:
        try:
            data, sender = arrived_at.recvfrom(_LONGEST)
        except ConnectionError:
            # Nobody listens any more where the last packet went.
            return
        if arrived_at is self._front:
            through, to = self._towards_server(sender), self._target
        else:
            through, to = self._front, self._behind[arrived_at]
        if len(self._waiting) < _MAX_WAITING:
            due_s = time.monotonic() + self._random.uniform(*self._delay_s)
            heapq.heappush(self._waiting, _Waiting(due_s, next(self._numbers), through, to, data))

    def _towards_server(self, client: Address) -> socket.socket:
        if client not in self._of_client:
            made = _bound(("127.0.0.1", 0))
            self._of_client[client], self._behind[made] = made, client
        return self._of_client[client]

    def _deliver(self, now_s: float) -> None:
        while self._waiting and self._waiting[0].due_s <= now_s:
            due = heapq.heappop(self._waiting)
            newest = self._newest.get(due.to, -1)
            self.carried += 1
            self.overtaken += due.number < newest
            self._newest[due.to] = max(newest, due.number)
            due.through.sendto(due.data, due.to)


def _bound(at: Address) -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.bind(at)
    return made


def _within(left_s: float) -> float:
    """Return how long to wait for packets: not past the next delivery, nor past the end."""
    return min(max(left_s, 0.0), 0.01)
