"""What is told of the service itself: writes, and time."""

from dataclasses import dataclass

from domain.events.event import Event


@dataclass(frozen=True, slots=True)
class WriteAnswered(Event):
    """A request that was to change something was answered; the audit trail."""

    kind = "audit.write"
    is_input = True
    is_notable = False

    method: str
    path: str
    status: int
    """Of HTTP."""
    address: str
    """Host and port of who asked."""

    def _words(self) -> str:
        return f"{self.method} {self.path} from {self.address} answered {self.status}"


@dataclass(frozen=True, slots=True)
class TimeWasDue(Event):
    """A deadline passed, or something was old or bad for long enough."""

    kind = "time.passed"
    is_input = True
    is_notable = False

    def _words(self) -> str:
        return "a deadline passed"
