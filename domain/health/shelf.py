"""The shelf: errors that somebody silenced for a time, with a reason.

Source: ISA-18.2, shelving.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from domain.deadlines import Deadlines
from domain.inputs import MAX_SHELF
from domain.kept import KeptClock, KeptShelf
from domain.outbox import Outbox
from domain.snapshot import ErrorKey, ShelfView
from domain.timebase import Duration, Instant, seconds

KEEPS_TIME_EVERY = seconds(5)
"""How often the time is kept while something is shelved: so much longer an error may be shelved
after a restart."""


@dataclass(frozen=True, slots=True)
class Shelved:
    """An error on the shelf."""

    view: ShelfView
    event: int
    """Id of the event that recorded it."""


class Shelf:
    """What is shelved, over a restart too; its time does not run down while the service is down."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._shelved: dict[ErrorKey, Shelved] = {}
        self._deadlines: Deadlines[ErrorKey] = Deadlines()
        self._keep_time_at: Instant = 0

    def __getitem__(self, key: ErrorKey) -> ShelfView | None:
        """Return the shelving of an error; None: it is not shelved."""
        shelved = self._shelved.get(key)
        return None if shelved is None else shelved.view

    def put(self, key: ErrorKey, view: ShelfView, event: int, now: Instant) -> None:
        """Shelve an error; it replaces an earlier shelving.

        Args:
            key: The error.
            view: Until when, why and by whom.
            event: Id of the event that recorded it.
            now: The current time.
        """
        if not self._shelved:
            self._keep_time(now)
        self._shelved[key] = Shelved(view, event)
        self._deadlines.set(key, view.until)
        self._outbox.keep(KeptShelf(key.part, key.error, view.until, view.reason, view.by))

    def remove(self, key: ErrorKey) -> Shelved | None:
        """Take an error off the shelf; return how it was shelved, None: it was not."""
        shelved = self._shelved.pop(key, None)
        if shelved is not None:
            self._deadlines.clear(key)
            self._outbox.forget(KeptShelf, key.name)
            if not self._shelved:
                self._outbox.forget(KeptClock, "")
        return shelved

    def wake_at(self) -> Instant | None:
        """Return when a time is up, or the time has to be kept; None: nothing is shelved."""
        due = self._deadlines.next()
        return None if due is None else min(due, self._keep_time_at)

    def pass_time(self, now: Instant) -> list[tuple[ErrorKey, Shelved]]:
        """Take the errors off the shelf whose time is up; return them as they were shelved."""
        ended = []
        while (key := self._deadlines.pop_due(now)) is not None:
            shelved = self.remove(key)
            if shelved is not None:
                ended.append((key, shelved))
        if self._shelved and now >= self._keep_time_at:
            self._keep_time(now)
        return ended

    def _keep_time(self, now: Instant) -> None:
        self._outbox.keep(KeptClock(now))
        self._keep_time_at = now + KEEPS_TIME_EVERY


def shelves_after(kept: Iterable[object], now: Instant) -> Mapping[ErrorKey, ShelfView]:
    """Return what was shelved, each for as long as it still was when the service went down."""
    values = tuple(kept)
    stopped = max((value.at for value in values if isinstance(value, KeptClock)), default=now)
    down: Duration = max(0, now - stopped)
    found = {}
    for value in values:
        if isinstance(value, KeptShelf):
            until = min(value.until + down, now + MAX_SHELF)
            found[ErrorKey(value.part, value.error)] = ShelfView(until, value.reason, value.by)
    return found
