"""Runs deterministic objects, which report when they are due next, in real time."""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from typing import Generic, Protocol, TypeVar

from domain.timebase import Instant
from service.clock import Clock

MessageT = TypeVar("MessageT")
MessageT_co = TypeVar("MessageT_co", covariant=True)


class Paced(Protocol[MessageT_co]):
    """An object that advances when it is given the time."""

    def advance(self, now: Instant) -> Sequence[MessageT_co]:
        """Advance to `now`, and return the messages that are due by then."""
        ...

    def wake_at(self) -> Instant | None:
        """Return when a message is due next; None: not before there is new input.

        After `advance(now)` this is later than `now`.
        """
        ...


AT_ONCE = 15
"""Messages delivered in one turn of the event loop."""


class Pacer(Generic[MessageT]):
    """Advances one object at exactly the times that it asks for, and whenever it gets input."""

    def __init__(self, paced: Paced[MessageT], clock: Clock) -> None:
        self._paced = paced
        self._clock = clock
        self._resting: asyncio.Future[None] | None = None

    def touch(self) -> None:
        """Advance soon, since the object got input that may have changed when it is due.

        May be called at any time on the event loop's thread, also from `deliver`.
        """
        if self._resting is not None:
            self._resting.cancel()

    async def run(
        self,
        deliver: Callable[[MessageT], None],
        deliver_many: Callable[[Sequence[MessageT], Instant], Awaitable[None]] | None = None,
    ) -> None:
        """Pass messages on in order when they are due, until cancelled.

        Args:
            deliver: Gets one message.
            deliver_many: Gets more than `AT_ONCE` messages that are due together, and up to when
                all that was due is delivered; lets other tasks run in between. None: there are
                never so many.
        """
        delivered = self._clock.now()
        while True:
            now = self._clock.now()
            due = self._paced.advance(now)
            if deliver_many is not None and len(due) > AT_ONCE:
                await deliver_many(due, delivered)
            else:
                for message in due:
                    deliver(message)
            delivered = now
            await self._rest()

    async def _rest(self) -> None:
        """Wait until something is due or the object gets input."""
        due = self._paced.wake_at()
        if due is None:
            resting: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        else:
            resting = asyncio.create_task(self._clock.sleep_until(due), name="rest of a pacer")
        self._resting = resting
        try:
            await asyncio.wait((resting,))
        finally:
            resting.cancel()
        if not resting.cancelled():
            resting.result()


class Alarm:
    """Rings at the time that `due` returns, which may change at any time."""

    def __init__(
        self, due: Callable[[], Instant | None], ring: Callable[[], object], clock: Clock
    ) -> None:
        """Prepare.

        Args:
            due: Returns when to ring next; None: not at all. After a ring it is in the future.
            ring: Called then.
            clock: Of the service.
        """
        self._due = due
        self._ring = ring
        self._waits_until: Instant | None = None
        self._pacer = Pacer[object](self, clock)

    def check(self) -> None:
        """Check again when to ring, since that may be earlier now."""
        due = self._due()
        if due is not None and (self._waits_until is None or due < self._waits_until):
            self._pacer.touch()

    async def run(self) -> None:
        """Ring until cancelled."""
        await self._pacer.run(lambda _: None)

    def advance(self, now: Instant) -> Sequence[object]:
        """Ring if that is due."""
        due = self._due()
        if due is not None and due <= now:
            self._ring()
        return ()

    def wake_at(self) -> Instant | None:
        """Return when to ring next, and remember it, so that `check` can compare."""
        self._waits_until = self._due()
        return self._waits_until
