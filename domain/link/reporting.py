"""When a device tells the supervisor what: changes at once, and everything each second."""

from collections.abc import Iterator

from domain.computers import Session
from domain.link.facts import Facts
from domain.link.messages import Report, Told
from domain.link.ownership import with_ages
from domain.link.peer import Own
from domain.link.settings import LinkSettings
from domain.timebase import Instant

_MAX_WAITING = 4_096
"""What changed at one moment, at most; of more, everything is told instead."""


class Reporting:
    """The facts of the device, and what of them the supervisor was not told yet."""

    def __init__(self, own: Own, settings: LinkSettings) -> None:
        """Begin without facts, and without a supervisor that hears them."""
        self._own = own
        self._settings = settings
        self._facts = Facts()
        self._waiting: list[Told] = []
        self._waits_since: Instant = 0
        self._seq = 0
        self._all_at: Instant | None = None
        """When everything is told next; None: nobody hears it."""
        self._told_all_at: Instant | None = None

    def wake_at(self) -> Instant | None:
        """Return when something is to be told next; None: nobody hears it."""
        if self._all_at is None or not self._waiting:
            return self._all_at
        return min(self._waits_since, self._all_at)

    def begin(self, now: Instant) -> None:
        """Tell everything: a supervisor hears it from now on."""
        self._waiting.clear()
        self._all_at = now

    def stop(self) -> None:
        """Tell nothing any more: nobody hears it."""
        self._waiting.clear()
        self._all_at = self._told_all_at = None

    def ask_all(self, now: Instant, *, at_once: bool) -> None:
        """Tell everything sooner, unless nobody hears it.

        Args:
            now: The current time.
            at_once: Even if it was just told.
        """
        if self._all_at is None:
            return
        earliest = now
        if not at_once and self._told_all_at is not None:
            earliest = max(now, self._told_all_at + self._settings.missed_report)
        self._all_at = min(self._all_at, earliest)

    def note(self, told: Told, now: Instant, *, is_heard: bool) -> None:
        """Note what is to be told.

        Args:
            told: A fact, or an answer.
            now: The current time.
            is_heard: Whether there is a supervisor to be told of it.
        """
        self._facts.note(told, now)
        if not is_heard or self._all_at is None:
            return
        if len(self._waiting) == _MAX_WAITING:
            self._waiting.clear()
            self._all_at = now
        if not self._waiting:
            self._waits_since = now
        self._waiting.append(told)

    def reports(self, session: Session, now: Instant) -> Iterator[Report]:
        """Yield what is due now."""
        if self._all_at is None:
            return
        if self._waiting:
            items = tuple(with_ages(told, now) for told in self._waiting)
            self._waiting.clear()
            yield self._report(items, session, complete=False)
        if now >= self._all_at:
            self._all_at, self._told_all_at = now + self._settings.report, now
            items = tuple(with_ages(told, now) for told in self._facts.all())
            yield self._report(items, session, complete=True)

    def _report(self, items: tuple[Told, ...], session: Session, *, complete: bool) -> Report:
        self._seq += 1
        own = self._own
        return Report(own.name, own.incarnation, self._seq, items, complete, session)
