"""How one error is announced: by what its source finds, and by what operators have seen of it.

Source: ISA-18.2, states of an alarm.
"""

from typing import NamedTuple

from domain.snapshot import ErrorState
from domain.timebase import Instant


class Evidence(NamedTuple):
    """What a source says of an error now."""

    state: ErrorState
    """`normal`, `pending`, `active`, or `latched`: its source keeps it on until it is
    acknowledged."""
    lingers: bool = False
    """It is active for its minimum time only: its cause is gone."""

    @property
    def has_cause(self) -> bool:
        """Tell whether the cause of an error that is on is present."""
        return self.state is ErrorState.ACTIVE and not self.lingers


class Alarm(NamedTuple):
    """One error as it is announced."""

    found: Evidence = Evidence(ErrorState.NORMAL)
    unseen: bool = False
    """It was raised, and nobody has acknowledged that."""
    raised: Instant | None = None
    """When it was raised last; None: it is neither on nor unseen."""
    ended: Instant | None = None
    """When its cause was gone; None: it is present, or there was none."""

    @property
    def state(self) -> ErrorState:
        """Return its state for operators."""
        match self.found.state:
            case ErrorState.NORMAL:
                return ErrorState.RETURNED if self.unseen else ErrorState.NORMAL
            case ErrorState.ACTIVE:
                return ErrorState.ACTIVE if self.unseen else ErrorState.ACKNOWLEDGED
            case other:
                return other

    def after(self, found: Evidence, since: Instant, now: Instant, *, latches: bool) -> "Alarm":
        """Return the alarm after its source found something.

        Args:
            found: What was found.
            since: When the error was raised, if that is found.
            now: The current time.
            latches: Whether an error that nobody acknowledged stays on after its cause is gone.
        """
        was_on = self.state.is_on
        if latches and was_on and self.unseen and not found.state.is_on:
            found = Evidence(ErrorState.LATCHED)
        # An acknowledgement is void when the cause comes again.
        comes = found.has_cause and not self.found.has_cause
        is_new = found.state.is_on and (not was_on or found.state is ErrorState.LATCHED)
        unseen = self.unseen or comes or is_new
        if found.state.is_on:
            raised = self.raised if was_on else since
        else:
            raised = self.raised if unseen else None
        goes = self.found.has_cause and not found.has_cause
        ended = now if goes else self.ended
        return Alarm(found, unseen, raised, None if found.has_cause or raised is None else ended)

    def acknowledged(self) -> "Alarm":
        """Return the alarm after somebody acknowledged it; one that only waited for that is over.

        While the cause is present, the acknowledgement counts when the cause goes.
        """
        if self.found.state is ErrorState.LATCHED:
            return QUIET
        if not self.found.state.is_on:
            return Alarm(self.found)
        return self._replace(unseen=False)


QUIET = Alarm()
"""There is nothing to announce."""
