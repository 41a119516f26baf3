"""The work that all connections together may cause in one turn of the event loop."""

import asyncio
from collections import deque
from collections.abc import Callable
from enum import IntEnum
from typing import Protocol

from api.serving.pieces import READ_COST

BUDGET = 2_000
"""Work of one turn, in nominal microseconds."""
RECENT_TURNS = 250
"""Whoever was served within so many turns has had its share, and comes after the others."""


class Urgency(IntEnum):
    """Who is served first."""

    STOP = 0
    """Asks for an emergency stop."""
    PAUSE = 1
    """Asks for something else that may make the robot safer, as 50 clients do that set holds."""
    REST = 2


class Work(Protocol):
    """A connection with bytes that wait."""

    urgency: Urgency
    """Of its next message."""
    served_in: int
    """Number of the turn in which its last message was complete."""

    def serve(self) -> int:
        """Handle the next piece; return what that costs, 0: nothing that is complete waits."""
        ...


class Turns:
    """Serves connections in turn, each with one small piece, up to a budget per turn of the loop.

    Between two turns the loop runs everything else. Whoever was not served for a while comes before
    those that were, so that a single request does not wait behind many connections that send
    without end, whether or not these wait for their answers; of both the more urgent come first.
    Each turn begins with one piece of another of these queues, if somebody who is served before
    its first one began to wait later: so that none waits forever, and nobody is served twice
    before all who came earlier.
    """

    def __init__(self, call_soon: Callable[[Callable[[], None]], object]) -> None:
        """Start with an unspent budget.

        Args:
            call_soon: Calls a function in the next turn of the loop.
        """
        self._call_soon = call_soon
        self._queues: tuple[deque[tuple[int, Work]], ...] = tuple(
            deque() for _ in range(2 * len(Urgency))
        )
        """By urgency; then the same of those that were served recently. Each with a number that
        rises with when it began to wait."""
        self._waits = 0
        self._rank = 0
        """Of the queue whose first was served last because it had been overtaken."""
        self.number = 0
        """Of the current turn."""
        self._spent = 0
        self._is_called = False

    @classmethod
    def of(cls, loop: asyncio.AbstractEventLoop) -> "Turns":
        """Return turns of an event loop."""
        return cls(loop.call_soon)

    @property
    def has_room(self) -> bool:
        """Tell whether work may be done at once: nobody waits, and the budget is not spent."""
        return self._spent < BUDGET and not any(self._queues)

    def spend(self, cost: int) -> None:
        """Count work that was done at once."""
        self._spent += cost
        self._call()

    def wait(self, work: Work) -> None:
        """Let a connection wait that did not wait before."""
        had_share = self.number - work.served_in < RECENT_TURNS
        self._waits += 1
        self._queues[len(Urgency) * had_share + work.urgency].append((self._waits, work))
        self._call()

    def _call(self) -> None:
        if not self._is_called:
            self._is_called = True
            self._call_soon(self._run)

    def _run(self) -> None:
        self._is_called = False
        self._spent = 0
        self.number += 1
        self._serve_overtaken()
        while self._spent < BUDGET:
            queue = next(filter(None, self._queues), None)
            if queue is None:
                return
            self._serve(queue)
        self._call()

    def _serve_overtaken(self) -> None:
        """Serve one of a queue whose first was overtaken; of several queues each in turn."""
        count = len(self._queues)
        for rank in (*range(self._rank + 1, count), *range(self._rank + 1)):
            if self._is_overtaken(rank):
                self._rank = rank
                self._serve(self._queues[rank])
                return

    def _is_overtaken(self, rank: int) -> bool:
        """Tell whether somebody who is served before a queue began to wait after its first."""
        queue = self._queues[rank]
        return bool(queue) and any(
            before[-1][0] > queue[0][0] for before in self._queues[:rank] if before
        )

    def _serve(self, queue: deque[tuple[int, Work]]) -> None:
        """Serve the first who has a complete piece; the others wait for more bytes to arrive."""
        while queue and self._spent < BUDGET:
            _, work = queue.popleft()
            cost = work.serve()
            self._spent += cost or READ_COST
            if cost:
                self.wait(work)
                return
