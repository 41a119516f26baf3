"""Events of the processes of nodes."""

from dataclasses import dataclass

from domain.events.event import Event
from domain.process_terms import ProcessAction
from domain.state_and_mode import PartName


@dataclass(frozen=True, slots=True)
class ProcessStarted(Event):
    """The process of a node runs."""

    kind = "process.started"
    is_input = True

    node: PartName
    pid: int

    def _words(self) -> str:
        return f"the process of {self.node} runs: {self.pid}"


@dataclass(frozen=True, slots=True)
class ProcessEnded(Event):
    """The process of a node ended, or could not be started."""

    kind = "process.ended"
    is_input = True

    node: PartName
    code: int | None
    """Exit code; null: a signal ended it, or it was never started."""
    signal: str
    """Name of the signal that ended it; empty: none did."""
    reason: str
    """How it ended, in words."""

    def _words(self) -> str:
        return f"the process of {self.node} ended: {self.reason}"


@dataclass(frozen=True, slots=True)
class ProcessReady(Event):
    """The process of a node can be started: nothing of it runs yet."""

    kind = "process.ready"
    is_input = True
    is_notable = False

    node: PartName

    def _words(self) -> str:
        return f"the process of {self.node} does not run yet"


@dataclass(frozen=True, slots=True)
class ProcessRequested(Event):
    """Somebody asked for the start, the end or a restart of the process of a node."""

    kind = "process.requested"
    is_input = True

    node: PartName
    action: ProcessAction

    def _words(self) -> str:
        return f"{self.action} of the process of {self.node} requested"


@dataclass(frozen=True, slots=True)
class ProcessWaits(Event):
    """The process of a node ended, and is started again after the back-off."""

    kind = "process.waits"
    is_notable = False

    node: PartName
    for_s: float
    """Back-off, in seconds."""
    starts_left: int
    """How often it may be started within the time of its budget, the next start included."""

    def _words(self) -> str:
        return f"the process of {self.node} is started again in {self.for_s:g} s"


@dataclass(frozen=True, slots=True)
class ProcessGivenUp(Event):
    """The process of a node ended too often; it is not started again before somebody asks."""

    kind = "process.given_up"

    node: PartName
    starts: int
    within_s: float

    def _words(self) -> str:
        often = f"started {self.starts} times in {self.within_s:g} s"
        return f"the process of {self.node} is not started again: {often}"
