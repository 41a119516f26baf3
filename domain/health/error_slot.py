"""Room for one error of a signal: what keeps it on after its cause is gone."""

from domain.health.signals import Recovery
from domain.timebase import Duration, Instant


class ErrorSlot:
    """Holds at most one error, for a least time and, if so set, until it is acknowledged.

    Errors that share a slot exclude each other: a new one takes the place of the old one at once,
    least time or not, since the robot stays in ERROR all the same.
    """

    def __init__(self, min_on: Duration, recovery: Recovery) -> None:
        self._min_on = min_on
        self._recovery = recovery
        self._hold_until: Instant = 0
        self._acknowledged = False
        self.error: str | None = None
        """The error that is on."""
        self.cause: str | None = None
        """The error whose cause is present now."""
        self.since: Instant = 0
        """When the error that is on came on."""

    def begin_with(self, error: str, start: Instant) -> None:
        """Let `error` be on from the start, for no longer than its cause."""
        self.error = self.cause = error
        self.since = self._hold_until = start

    def update(self, cause: str | None, now: Instant) -> None:
        """Say which cause is present now, and let end what may end.

        A cause that comes back while its error is still on needs a new acknowledgement.
        """
        if cause is not None and cause != self.cause:
            self._acknowledged = False
        if cause is not None and cause != self.error:
            self.error = cause
            self.since = now
            self._hold_until = now + self._min_on
        self.cause = cause
        if self._ends_with_time and now >= self._hold_until:
            self.error = None

    def acknowledge(self) -> None:
        """Acknowledge the error that is on; call `update` to let it end.

        While the cause is present, this is remembered until the cause goes.
        """
        self._acknowledged = self.error is not None

    @property
    def wake_at(self) -> Instant | None:
        """Return when time alone ends the error; None: never."""
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
