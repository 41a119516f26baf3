"""Stalls of the service itself, told at a bounded rate."""

from domain.concern import Concern, Takers
from domain.events.service import ServiceStalled
from domain.inputs import ServiceStall
from domain.outbox import Outbox
from domain.timebase import Duration, Instant, seconds, to_seconds

TOLD_EVERY: Duration = seconds(10)
"""A host that stays busy must not fill the event log."""


class Stalls(Concern):
    """Tells of a stall at once, but at most every `TOLD_EVERY`; then the longest one counts."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._told_at: Instant | None = None
        self._longest: Duration = 0
        """Of those that were not told."""

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {ServiceStall: self.take_stall}

    def take_stall(self, stall: ServiceStall, now: Instant) -> None:
        """Tell of a stall, or remember it until one may be told again."""
        self._longest = max(self._longest, stall.late)
        if self._told_at is not None and now - self._told_at < TOLD_EVERY:
            return
        self._outbox.begin(now, ServiceStalled(to_seconds(self._longest)))
        self._outbox.record_input()
        self._told_at, self._longest = now, 0
