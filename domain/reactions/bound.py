"""How often something may happen within a time."""

from domain.timebase import Duration, Instant


class Bound:
    """At most so many times within a sliding window."""

    def __init__(self, most: int, window: Duration) -> None:
        self._most = most
        self._window = window
        self._at: list[Instant] = []
        """The last times, not more than may be."""

    def free_at(self, now: Instant) -> Instant:
        """Return when it may happen next; `now`, if it may at once."""
        if len(self._at) < self._most:
            return now
        return max(now, self._at[0] + self._window)

    def note(self, now: Instant) -> None:
        """Note that it happens."""
        self._at = [*self._at, now][-self._most :]
