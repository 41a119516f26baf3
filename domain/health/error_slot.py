"""One error of a signal, and what keeps it active after its cause is gone."""

from domain.health.signals import Recovery
from domain.timebase import Duration, Instant


class ErrorSlot:
    """Holds at most one error, for a minimum time and, if configured, until it is acknowledged.

    Errors that share a slot exclude each other: a new one replaces the old one at once, minimum
    time or not, since the robot stays in ERROR either way.
    """

    def __init__(self, min_on: Duration, recovery: Recovery, clear_for: Duration = 0) -> None:
        """Begin without an error.

        Args:
            min_on: Minimum time that an error stays active.
            recovery: Whether it stays active until it is acknowledged.
            clear_for: How long its cause has to be gone.
        """
        self._min_on = min_on
        self._clear_for = clear_for
        self._recovery = recovery
        self._hold_until: Instant = 0
        self._acknowledged = False
        self.error: str | None = None
        """The active error."""
        self.cause: str | None = None
        """The error whose cause is present now."""
        self.since: Instant = 0
        """When the active error was raised."""

    def begin_with(self, error: str, start: Instant) -> None:
        """Raise `error` at the start; it has no minimum time."""
        self.error = self.cause = error
        self.since = self._hold_until = start

    def restore(self, error: str, since: Instant) -> None:
        """Raise an error of an earlier run, whose cause is not known to be present."""
        self.error, self.since = error, since
        self._hold_until = since + self._min_on

    def update(self, cause: str | None, now: Instant) -> None:
        """Set the cause that is present now, and clear the error if it may end.

        A cause that reappears while its error is still active needs a new acknowledgement.
        """
        if cause is not None and cause != self.cause:
            self._acknowledged = False
        if cause is not None and cause != self.error:
            self.error = cause
            self.since = now
            self._hold_until = now + self._min_on
        if cause is None and self.cause is not None:
            self._hold_until = max(self._hold_until, now + self._clear_for)
        self.cause = cause
        if self._ends_with_time and now >= self._hold_until:
            self.error = None

    def acknowledge(self) -> None:
        """Acknowledge the active error; call `update` to clear it.

        While the cause is present, the acknowledgement is kept until the cause is gone.
        """
        self._acknowledged = self.error is not None

    @property
    def wake_at(self) -> Instant | None:
        """Return when time alone clears the error; None: never."""
        return self._hold_until if self._ends_with_time else None

    @property
    def waits_for_acknowledgement(self) -> bool:
        """Tell whether an operator has yet to acknowledge the error."""
        return (
            self.error is not None
            and self._recovery is Recovery.ACKNOWLEDGE
            and not self._acknowledged
        )

    @property
    def _ends_with_time(self) -> bool:
        is_kept_on = self.error is not None and self.cause is None
        return is_kept_on and not self.waits_for_acknowledgement
