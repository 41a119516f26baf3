"""What the readings of one signal go to."""

from typing import Protocol

from domain.health.good_range import GoodRange, good_in_all
from domain.timebase import Instant
from domain.windows.shared import SharedWindows


class Fed(Protocol):
    """A monitor, as far as its readings are concerned."""

    @property
    def harmless(self) -> GoodRange:
        """Return the readings that take its value nowhere at once."""
        ...

    @property
    def owed_at(self) -> Instant | None:
        """Return when a reading has to be taken account of; None: all are."""
        ...

    @property
    def owed_until(self) -> Instant | None:
        """Return when it has to be even if no other reading comes; None: all are."""
        ...

    def feed(self, value: float, now: Instant) -> bool:
        """Note a reading, and tell whether it has to be taken account of now."""
        ...


class Feed:
    """The windows over one signal, and its monitors.

    Most readings concern no monitor when they come: each of them owes taking account of earlier
    ones already, and is not due yet. Those readings are only noted.
    """

    def __init__(self, start: Instant) -> None:
        """Begin without monitors.

        Args:
            start: Since when readings would have been heard.
        """
        self.windows = SharedWindows(start)
        self._monitors: list[Fed] = []
        self._harmless = GoodRange()
        self._waits_until: Instant = start
        """Until then all monitors wait."""

    def join(self, monitor: Fed) -> None:
        """Let a monitor have the readings; it says when what is harmless to it changes."""
        self._monitors.append(monitor)
        self.note_harmless()

    def note_harmless(self) -> None:
        """Note that what is harmless to a monitor may have changed."""
        self._harmless = good_in_all(monitor.harmless for monitor in self._monitors)

    def note_judged(self) -> None:
        """Note that a monitor owes nothing any more."""
        self._waits_until = 0

    def take(self, value: float, now: Instant) -> bool:
        """Take in a reading, and tell whether monitors have to be fed."""
        self.windows.add(now, value)
        lowest, highest = self._harmless
        return now >= self._waits_until or not lowest <= value <= highest

    def note_fed(self) -> None:
        """Note that all monitors were fed: they wait until the first of them is due."""
        waits_until: Instant | None = None
        for monitor in self._monitors:
            at = monitor.owed_at
            if at is not None and (waits_until is None or at < waits_until):
                waits_until = at
        self._waits_until = waits_until or 0

    def owed_until(self) -> Instant | None:
        """Return when a monitor has to take account of a reading at the latest; None: none has."""
        until: Instant | None = None
        for monitor in self._monitors:
            at = monitor.owed_until
            if at is not None and (until is None or at < until):
                until = at
        return until
