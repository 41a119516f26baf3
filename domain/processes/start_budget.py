"""How often a process was started lately; also over a restart of the service."""

from collections.abc import Iterable

from domain.timebase import Duration, Instant


class StartBudget:
    """At most so many starts within a sliding window.

    While the service is down, no time passes: to kill it gives no process new starts.
    """

    def __init__(self, most: int, within: Duration) -> None:
        self._most = most
        self._within = within
        self._starts: tuple[Instant, ...] = ()
        """Those that count, the oldest first."""

    def left(self) -> int:
        """Return how many starts are left."""
        return max(0, self._most - len(self._starts))

    def note(self, now: Instant) -> None:
        """Note a start."""
        self._starts = (*self._starts, now)

    def refill(self) -> None:
        """Forget all starts."""
        self._starts = ()

    def wake_at(self) -> Instant | None:
        """Return when the oldest start counts no more; None: none counts."""
        return self._starts[0] + self._within if self._starts else None

    def pass_time(self, now: Instant) -> None:
        """Forget the starts that count no more."""
        self._starts = tuple(at for at in self._starts if at + self._within > now)

    def ages(self, now: Instant) -> tuple[Duration, ...]:
        """Return how long ago each start was that counts."""
        return tuple(now - at for at in self._starts)

    def restore(self, ages: Iterable[Duration], now: Instant) -> None:
        """Note the starts of an earlier run of the service."""
        self._starts = tuple(now - age for age in ages)
        self.pass_time(now)
