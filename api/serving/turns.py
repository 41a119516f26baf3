"""The work that all connections together may cause in one turn of the event loop."""

import asyncio
from collections import deque
from collections.abc import Callable
from typing import Protocol

BUDGET = 2_000
"""Work of one turn, in nominal microseconds."""


class Work(Protocol):
    """A connection with bytes that wait."""

    is_urgent: bool
    """Whether it is served before all others."""

    def serve(self) -> int:
        """Handle the next piece; return what that costs, 0: nothing that is complete waits."""
        ...


class Turns:
    """Serves connections in turn, each with one small piece, up to a budget per turn of the loop.

    Between two turns the loop runs everything else. A connection that has just begun to wait comes
    before those that waited already when it was last served, so that a single request does not wait
    behind many connections that send without end; urgent ones come first.
    """

    def __init__(self, call_soon: Callable[[Callable[[], None]], object]) -> None:
        """Start with an unspent budget.

        Args:
            call_soon: Calls a function in the next turn of the loop.
        """
        self._call_soon = call_soon
        self._urgent: deque[Work] = deque()
        self._fresh: deque[Work] = deque()
        self._others: deque[Work] = deque()
        self._spent = 0
        self._is_called = False

    @classmethod
    def of(cls, loop: asyncio.AbstractEventLoop) -> "Turns":
        """Return turns of an event loop."""
        return cls(loop.call_soon)

    @property
    def has_room(self) -> bool:
        """Tell whether work may be done at once: nobody waits, and the budget is not spent."""
        return self._spent < BUDGET and not (self._urgent or self._fresh or self._others)

    def spend(self, cost: int) -> None:
        """Count work that was done at once."""
        self._spent += cost
        self._call()

    def wait(self, work: Work) -> None:
        """Let a connection wait that did not wait before."""
        (self._urgent if work.is_urgent else self._fresh).append(work)
        self._call()

    def _call(self) -> None:
        if not self._is_called:
            self._is_called = True
            self._call_soon(self._run)

    def _run(self) -> None:
        self._is_called = False
        self._spent = 0
        while self._spent < BUDGET:
            queue = self._urgent or self._fresh or self._others
            if not queue:
                return
            work = queue.popleft()
            cost = work.serve()
            if cost:
                self._spent += cost
                (self._urgent if work.is_urgent else self._others).append(work)
        self._call()
