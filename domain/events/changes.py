"""Events of changes of state, mode and parameters, and of nodes that reappear."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from domain.events.event import Event, because
from domain.identifiers import ChangeId
from domain.lifecycle import Transition
from domain.parameters import Parameters
from domain.snapshot import ChangeStatus, StepStatus
from domain.state_and_mode import PartName, StateAndMode


@dataclass(frozen=True, slots=True)
class ChangeRequested(Event):
    """A change of state, mode or parameters is requested."""

    kind = "change.requested"
    is_input = True
    is_notable = False
    optional = frozenset({"mode", "transition", "parameters"})

    part: PartName
    mode: str | None = None
    transition: Transition | None = None
    parameters: Parameters | None = None

    def _words(self) -> str:
        if self.parameters is not None:
            return f"{self.part}: parameters {', '.join(self.parameters)} requested"
        return f"{self.part}: {self.mode or self.transition} requested"


@dataclass(frozen=True, slots=True)
class ChangeCancelRequested(Event):
    """A cancel of a change is requested."""

    kind = "change.cancel_requested"
    is_input = True
    is_notable = False

    change: str

    def _words(self) -> str:
        return f"cancel of change {self.change} requested"


@dataclass(frozen=True, slots=True)
class StepStarted(Event):
    """A node is asked for one step of a change."""

    kind = "change.step_started"
    is_notable = False

    change: ChangeId
    node: PartName
    action: str

    def _words(self) -> str:
        return f"{self.node}: {self.action}"


@dataclass(frozen=True, slots=True)
class StepEnded(Event):
    """A step of a change ended."""

    kind = "change.step_ended"
    is_notable = False

    change: ChangeId
    node: PartName
    action: str
    status: StepStatus
    error: str | None

    def _words(self) -> str:
        status = self.status.replace("_", " ")
        return because(f"{self.node}: {self.action} {status}", self.error)


@dataclass(frozen=True, slots=True)
class NodeAnswered(Event):
    """A node accepts or rejects a step; accepted is not done."""

    kind = "node.answered"
    is_input = True
    is_notable = False

    node: PartName
    accepted: bool
    reason: str

    def _words(self) -> str:
        answer = "accepts" if self.accepted else "rejects"
        return because(f"{self.node} {answer} the request", self.reason)


@dataclass(frozen=True, slots=True)
class ChangeWaiting(Event):
    """A change waits until what its modes require is true."""

    kind = "change.waiting"

    change: ChangeId
    part: PartName
    reason: str

    def _words(self) -> str:
        return because(f"{self.part}: change waits", self.reason)


@dataclass(frozen=True, slots=True)
class ChangeEnded(Event):
    """A change ended; each status has its own kind."""

    status: ClassVar[ChangeStatus]

    change: ChangeId
    part: PartName
    reason: str | None

    def _words(self) -> str:
        ending = self.status.replace("_", " ")
        return because(f"{self.part}: change {ending}", self.reason)


@dataclass(frozen=True, slots=True)
class ChangeSucceeded(ChangeEnded):
    """A change succeeded: every node was verified to be in its target state and mode."""

    kind = "change.succeeded"
    status = ChangeStatus.SUCCEEDED


@dataclass(frozen=True, slots=True)
class ChangeFailed(ChangeEnded):
    """A change failed: a step failed, or the part did not reach its target."""

    kind = "change.failed"
    status = ChangeStatus.FAILED


@dataclass(frozen=True, slots=True)
class ChangeTimedOut(ChangeEnded):
    """A change timed out: a step missed its deadline and the outcome is unknown."""

    kind = "change.timed_out"
    status = ChangeStatus.TIMED_OUT


@dataclass(frozen=True, slots=True)
class ChangeSuperseded(ChangeEnded):
    """A change was superseded: a newer one took over at least one of its nodes."""

    kind = "change.superseded"
    status = ChangeStatus.SUPERSEDED


@dataclass(frozen=True, slots=True)
class ChangeCanceled(ChangeEnded):
    """A change was canceled on request."""

    kind = "change.canceled"
    status = ChangeStatus.CANCELED


CHANGE_ENDS: Mapping[ChangeStatus, type[ChangeEnded]] = {
    end.status: end
    for end in (ChangeSucceeded, ChangeFailed, ChangeTimedOut, ChangeSuperseded, ChangeCanceled)
}


@dataclass(frozen=True, slots=True)
class NodeRestoring(Event):
    """A node reappeared, and a change restores it to its target (`on_return`)."""

    kind = "node.restoring"

    node: PartName
    target: StateAndMode

    def _words(self) -> str:
        return f"{self.node} reappeared and is restored to {self.target.label}"


@dataclass(frozen=True, slots=True)
class NodeNotRestored(Event):
    """A node that reappeared is not restored, for a reason."""

    kind = "node.not_restored"

    node: PartName
    target: StateAndMode
    reason: str

    def _words(self) -> str:
        return because(f"{self.node} reappeared and is not restored", self.reason)


@dataclass(frozen=True, slots=True)
class BackendAvailable(Event):
    """The backend is available: nodes can be asked for something again."""

    kind = "backend.available"
    is_input = True
    is_notable = False

    reason: str

    def _words(self) -> str:
        return because("the backend is available", self.reason)


@dataclass(frozen=True, slots=True)
class BackendUnavailable(Event):
    """The backend is unavailable: no node can be reached at all."""

    kind = "backend.unavailable"
    is_input = True
    is_notable = False

    reason: str

    def _words(self) -> str:
        return because("the backend is unavailable", self.reason)
