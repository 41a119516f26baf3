"""Lets deterministic objects, which say themselves when they want to go on, do so in real time."""

import asyncio
from collections.abc import Callable, Sequence
from typing import Generic, Protocol, TypeVar

from domain.timebase import Instant
from service.clock import Clock

MessageT = TypeVar("MessageT")
MessageT_co = TypeVar("MessageT_co", covariant=True)


class Paced(Protocol[MessageT_co]):
    """Something that is advanced by being told the time."""

    def advance(self, now: Instant) -> Sequence[MessageT_co]:
        """Return what is due up to `now`."""
        ...

    def wake_at(self) -> Instant | None:
        """Return when there is next something due; None: only when something is handed in.

        After `advance(now)` this is later than `now`.
        """
        ...


_AT_ONCE = 100


class Pacer(Generic[MessageT]):
    """Advances one object at exactly the times that it asks for, and when it was touched."""

    def __init__(self, paced: Paced[MessageT], clock: Clock) -> None:
        self._paced = paced
        self._clock = clock
        self._resting: asyncio.Future[None] | None = None

    def touch(self) -> None:
        """Say that something was handed in: what is due, and when, may be different now.

        May be called at any time on the event loop's thread, also from within `deliver`.
        """
        if self._resting is not None:
            self._resting.cancel()

    async def run(self, deliver: Callable[[MessageT], None]) -> None:
        """Hand what comes due to `deliver`, in its order, until cancelled."""
        while True:
            for number, message in enumerate(self._paced.advance(self._clock.now()), start=1):
                deliver(message)
                if number % _AT_ONCE == 0:
                    # Thousands of nodes appear together, and the rest of the service runs on.
                    await asyncio.sleep(0)
            await self._rest()

    async def _rest(self) -> None:
        """Wait until something is due or was handed in."""
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
    """Rings at the time that `due` says, which moves with whatever happens."""

    def __init__(
        self, due: Callable[[], Instant | None], ring: Callable[[], object], clock: Clock
    ) -> None:
        """Prepare.

        Args:
            due: When to ring next; None: not at all. After a ring it is later than the present.
            ring: What to do then.
            clock: The present.
        """
        self._due = due
        self._ring = ring
        self._waits_until: Instant | None = None
        self._pacer = Pacer[object](self, clock)

    def check(self) -> None:
        """Look again when to ring, since that may be earlier now."""
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
        """Return when to ring next, and remember it as what is waited for."""
        self._waits_until = self._due()
        return self._waits_until
