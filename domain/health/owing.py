"""Which signals have readings that monitors did not take account of yet, and until when."""

from collections.abc import Mapping

from domain.deadlines import Deadlines
from domain.health.feed import Feed
from domain.timebase import Instant


class Owing:
    """The deadlines of all feeds.

    They are put off with almost every reading. Each is looked up when an earlier one comes up.
    """

    def __init__(self, feeds: Mapping[str, Feed]) -> None:
        """Begin with nothing owed.

        Args:
            feeds: By signal.
        """
        self._feeds = feeds
        self._deadlines: Deadlines[str] = Deadlines()
        """By signal, when its monitors owe something, or earlier."""

    def note(self, signal: str) -> None:
        """Note that monitors of a signal may owe taking account of its readings from now on."""
        at, noted = self._feeds[signal].owed_until(), self._deadlines.at(signal)
        if at is not None and (noted is None or at < noted):
            self._deadlines.set(signal, at)

    def next(self) -> Instant | None:
        """Return when a reading has to be taken account of; None: all are."""
        while (signal := self._deadlines.first()) is not None:
            at = self._feeds[signal].owed_until()
            if at is None:
                self._deadlines.clear(signal)
            elif at == self._deadlines.at(signal):
                return at
            else:
                self._deadlines.set(signal, at)
        return None

    def due(self, now: Instant) -> str | None:
        """Return the signal whose readings have to be taken account of; None: there is none.

        Whoever asks takes account of those that are due by now.
        """
        at = self.next()
        return None if at is None or at > now else self._deadlines.first()
