"""What happened, as values: one small class per kind of event.

An event is emitted with `Outbox.emit`, and read by its class and fields. What clients see of it
follows from the class: `kind`, `data`, the sentence for an operator in `words`, and whether that
belongs in a short list (`notable`). The documents of the interface are made from `EVENTS`.

To add a kind, add a class here and emit it; nothing else has to know.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import Enum
from typing import ClassVar

from domain.identifiers import ChangeId, GoalId, TaskId
from domain.inputs import SignalValue
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters
from domain.snapshot import ChangeStatus, StepStatus, SystemState, TaskPhase
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import Instant


class Event:
    """Something that was decided, or that became known."""

    __slots__ = ()

    kind: ClassVar[str]
    """Its name for clients, such as `change.succeeded`."""
    is_input: ClassVar[bool] = False
    """It came from outside or from the clock; recorded once something follows from it."""
    optional: ClassVar[frozenset[str]] = frozenset()
    """Fields that `data` leaves out while they are None."""
    hidden: ClassVar[frozenset[str]] = frozenset()
    """Fields that `data` never has."""
    is_notable: ClassVar[bool] = True
    """Whether a short list for operators has events of this kind."""

    @property
    def words(self) -> str:
        """Return what happened, as one sentence for an operator."""
        raise NotImplementedError

    @property
    def notable(self) -> bool:
        """Tell whether a short list for operators has this event."""
        return self.is_notable

    @classmethod
    def data_keys(cls) -> tuple[str, ...]:
        """Return the keys of `data`, in order."""
        return _keys(cls)

    def data(self) -> dict[str, object]:
        """Return the fields as clients see them: labels, texts, numbers, lists and mappings."""
        shown = {}
        for name in _keys(type(self)):
            value = getattr(self, name)
            if value is not None or name not in self.optional:
                shown[name] = _plain(value)
        return shown


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """An event in its place in the log."""

    id: int
    """Rises by one per event."""
    at: Instant
    cause: int | None
    """The event that led to this one; None: it came from outside, or from the clock."""
    actor: str
    """Who asked for it; empty: nobody."""
    event: Event

    @property
    def kind(self) -> str:
        """Return the name of its kind for clients."""
        return self.event.kind

    @property
    def data(self) -> Mapping[str, object]:
        """Return the fields of the event as clients see them."""
        return self.event.data()


_KEYS: dict[type[Event], tuple[str, ...]] = {}


def _keys(kind: type[Event]) -> tuple[str, ...]:
    """Return the keys of an event's data, looked up once per class."""
    known = _KEYS.get(kind)
    if known is None:
        names = (item.name for item in fields(kind))  # type: ignore[arg-type]
        known = _KEYS[kind] = tuple(name for name in names if name not in kind.hidden)
    return known


def _plain(value: object) -> object:
    if isinstance(value, StateAndMode):
        return value.label
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, tuple):
        return list(value)
    if isinstance(value, Mapping):
        return dict(value)
    return value


def _because(words: str, reason: str | None) -> str:
    return f"{words}: {reason}" if reason else words


# --- parts ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class NodeReported(Event):
    """A node, or the backend on its behalf, reports its state, mode, parameters or presence."""

    kind = "node.reported"
    is_input = True
    is_notable = False
    optional = frozenset({"state", "mode", "parameters", "reachable"})

    node: PartName
    state: LifecycleState | None = None
    mode: ModeName | None = None
    parameters: Parameters | None = None
    reachable: bool | None = None

    @property
    def words(self) -> str:
        """Return what was reported."""
        said = [str(value) for value in (self.state, self.mode) if value is not None]
        if self.parameters:
            said.append(f"parameters {', '.join(self.parameters)}")
        if self.reachable is False:
            said.append("unreachable")
        return f"{self.node} reports {', '.join(said) or 'that it is reachable'}"


@dataclass(frozen=True, slots=True)
class NodeReachable(Event):
    """A node is heard from, for the first time or again."""

    kind = "node.reachable"
    node: PartName

    @property
    def words(self) -> str:
        """Return which node is back."""
        return f"{self.node} is reachable"


@dataclass(frozen=True, slots=True)
class NodeUnreachable(Event):
    """A node is no longer heard from."""

    kind = "node.unreachable"
    node: PartName

    @property
    def words(self) -> str:
        """Return which node is gone."""
        return f"{self.node} is unreachable"


@dataclass(frozen=True, slots=True)
class PartActualChanged(Event):
    """A part entered another state or mode."""

    kind = "part.actual_changed"
    hidden = frozenset({"of_system"})

    part: PartName
    actual: StateAndMode
    was: StateAndMode
    reason: str | None
    of_system: bool = field(default=False, kw_only=True)
    """The part is a system; what becomes of its nodes one by one is detail."""

    @property
    def words(self) -> str:
        """Return the step from state to state."""
        return f"{self.part}: {self.was.label} -> {self.actual.label}"

    @property
    def notable(self) -> bool:
        """Tell whether the part is a system."""
        return self.of_system


@dataclass(frozen=True, slots=True)
class _Deviation(Event):
    """A part and its target, at one moment."""

    is_notable = False

    part: PartName
    target: StateAndMode | None
    actual: StateAndMode
    reason: str | None

    @property
    def words(self) -> str:
        """Return where the part is and where it should be."""
        wanted = self.target.label if self.target else "nothing in particular"
        return _because(f"{self.part} is {self.actual.label}, target {wanted}", self.reason)


@dataclass(frozen=True, slots=True)
class DeviationBegan(_Deviation):
    """A part is no longer in its target state and mode."""

    kind = "part.deviation_began"


@dataclass(frozen=True, slots=True)
class DeviationEnded(_Deviation):
    """A part is in its target state and mode again, or has no target any more."""

    kind = "part.deviation_ended"


# --- changes -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ChangeRequested(Event):
    """Somebody requests a change of state, mode or parameters."""

    kind = "change.requested"
    is_input = True
    is_notable = False
    optional = frozenset({"mode", "transition", "parameters"})

    part: PartName
    mode: str | None = None
    transition: Transition | None = None
    parameters: Parameters | None = None

    @property
    def words(self) -> str:
        """Return what is requested."""
        if self.parameters is not None:
            return f"{self.part}: parameters {', '.join(self.parameters)} requested"
        return f"{self.part}: {self.mode or self.transition} requested"


@dataclass(frozen=True, slots=True)
class ChangeCancelRequested(Event):
    """Somebody cancels a change."""

    kind = "change.cancel_requested"
    is_input = True
    is_notable = False

    change: str

    @property
    def words(self) -> str:
        """Return which change is canceled."""
        return f"cancel of change {self.change} requested"


@dataclass(frozen=True, slots=True)
class StepStarted(Event):
    """A node is asked for one step of a change."""

    kind = "change.step_started"
    is_notable = False

    change: ChangeId
    node: PartName
    action: str

    @property
    def words(self) -> str:
        """Return the step."""
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

    @property
    def words(self) -> str:
        """Return how the step ended."""
        status = self.status.replace("_", " ")
        return _because(f"{self.node}: {self.action} {status}", self.error)


@dataclass(frozen=True, slots=True)
class NodeAnswered(Event):
    """A node accepts or rejects a step; accepted is not done."""

    kind = "node.answered"
    is_input = True
    is_notable = False

    node: PartName
    accepted: bool
    reason: str

    @property
    def words(self) -> str:
        """Return the answer."""
        answer = "accepts" if self.accepted else "rejects"
        return _because(f"{self.node} {answer} the request", self.reason)


@dataclass(frozen=True, slots=True)
class ChangeEnded(Event):
    """A change ended; each way to end is a kind of its own."""

    status: ClassVar[ChangeStatus]

    change: ChangeId
    part: PartName
    reason: str | None

    @property
    def words(self) -> str:
        """Return how the change ended, and why."""
        ending = self.status.replace("_", " ")
        return _because(f"{self.part}: change {ending}", self.reason)


@dataclass(frozen=True, slots=True)
class ChangeSucceeded(ChangeEnded):
    """A change succeeded: every node was verified to be where it should be."""

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

    @property
    def words(self) -> str:
        """Return which node is restored, and to what."""
        return f"{self.node} reappeared and is restored to {self.target.label}"


@dataclass(frozen=True, slots=True)
class NodeNotRestored(Event):
    """A node that reappeared is not restored, for a reason."""

    kind = "node.not_restored"

    node: PartName
    target: StateAndMode
    reason: str

    @property
    def words(self) -> str:
        """Return why the node is left as it is."""
        return _because(f"{self.node} reappeared and is not restored", self.reason)


@dataclass(frozen=True, slots=True)
class BackendAvailable(Event):
    """The backend is available: nodes can be asked for something again."""

    kind = "backend.available"
    is_input = True
    is_notable = False

    reason: str

    @property
    def words(self) -> str:
        """Return that nodes can be reached."""
        return _because("the backend is available", self.reason)


@dataclass(frozen=True, slots=True)
class BackendUnavailable(Event):
    """The backend is unavailable: no node can be reached at all."""

    kind = "backend.unavailable"
    is_input = True
    is_notable = False

    reason: str

    @property
    def words(self) -> str:
        """Return why no node can be reached."""
        return _because("the backend is unavailable", self.reason)


# --- health --------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SignalRead(Event):
    """One or more readings arrived together."""

    kind = "signal.read"
    is_input = True
    is_notable = False

    source: str
    values: Mapping[str, SignalValue]

    @property
    def words(self) -> str:
        """Return what was read."""
        values = ", ".join(f"{signal} {value}" for signal, value in self.values.items())
        return f"{values} (source {self.source})"


@dataclass(frozen=True, slots=True)
class SignalPending(Event):
    """A signal is bad, and becomes an error unless it recovers in time."""

    kind = "signal.pending"
    is_notable = False

    signal: str
    error: str

    @property
    def words(self) -> str:
        """Return what follows if it lasts."""
        return f"{self.signal} is bad; {self.error} follows if it lasts"


@dataclass(frozen=True, slots=True)
class SignalSettled(Event):
    """A signal recovered before it became an error."""

    kind = "signal.settled"
    is_notable = False

    signal: str
    error: str

    @property
    def words(self) -> str:
        """Return which error did not come."""
        return f"{self.signal} recovered; no {self.error}"


@dataclass(frozen=True, slots=True)
class SignalSkewed(Event):
    """The clock of a signal's sender differs from ours by more than 1 s."""

    kind = "signal.skewed"
    is_notable = False

    signal: str

    @property
    def words(self) -> str:
        """Return whose clock differs."""
        return f"the clock of the sender of {self.signal} differs from ours by more than 1 s"


@dataclass(frozen=True, slots=True)
class ErrorRaised(Event):
    """An error is raised."""

    kind = "error.raised"

    error: str
    message: str
    value: object
    threshold: object

    @property
    def words(self) -> str:
        """Return the error and why it is on."""
        return f"{self.error}: {self.message}"


@dataclass(frozen=True, slots=True)
class ErrorCleared(Event):
    """An error is cleared."""

    kind = "error.cleared"

    error: str

    @property
    def words(self) -> str:
        """Return which error is over."""
        return f"{self.error} cleared"


@dataclass(frozen=True, slots=True)
class ErrorAcknowledged(Event):
    """Somebody acknowledges an error."""

    kind = "error.acknowledged"
    is_input = True

    error: str

    @property
    def words(self) -> str:
        """Return which error was acknowledged."""
        return f"{self.error} acknowledged"


@dataclass(frozen=True, slots=True)
class EmergencyStopEngaged(Event):
    """Somebody engages the emergency stop."""

    kind = "emergency_stop.engaged"
    is_input = True

    reason: str

    @property
    def words(self) -> str:
        """Return why the robot is stopped."""
        return _because("emergency stop engaged", self.reason)


@dataclass(frozen=True, slots=True)
class EmergencyStopReleased(Event):
    """Somebody releases the emergency stop."""

    kind = "emergency_stop.released"
    is_input = True

    reason: str

    @property
    def words(self) -> str:
        """Return that the stop is over."""
        return "emergency stop released"


@dataclass(frozen=True, slots=True)
class EmergencyStopStandstill(Event):
    """The vehicle was first seen at standstill after the emergency stop."""

    kind = "emergency_stop.standstill"

    @property
    def words(self) -> str:
        """Return that the vehicle stands."""
        return "the vehicle is at standstill after the emergency stop"


@dataclass(frozen=True, slots=True)
class SystemStateChanged(Event):
    """The state of the robot or its errors changed."""

    kind = "system_state.changed"

    state: SystemState
    was: SystemState
    errors: tuple[str, ...]
    error_code: int

    @property
    def words(self) -> str:
        """Return the step from state to state, with the errors."""
        step = self.state if self.state is self.was else f"{self.was} -> {self.state}"
        return _because(str(step), ", ".join(self.errors))


# --- driving -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class VehicleReported(Event):
    """The vehicle reports its pose and speed."""

    kind = "vehicle.reported"
    is_input = True
    is_notable = False

    x_m: float
    y_m: float
    speed_mps: float

    @property
    def words(self) -> str:
        """Return where the vehicle is."""
        return f"vehicle at x {self.x_m:.2f} m, y {self.y_m:.2f} m, {self.speed_mps:.2f} m/s"


@dataclass(frozen=True, slots=True)
class GoalProgressed(Event):
    """Navigation reports its progress towards a goal."""

    kind = "goal.feedback"
    is_input = True
    is_notable = False

    goal: GoalId

    @property
    def words(self) -> str:
        """Return which goal it is about."""
        return f"progress of goal {self.goal}"


@dataclass(frozen=True, slots=True)
class GoalEnded(Event):
    """Navigation ended its goal by itself."""

    kind = "goal.ended"
    is_input = True
    is_notable = False

    goal: GoalId
    succeeded: bool
    reason: str

    @property
    def words(self) -> str:
        """Return how the goal ended."""
        ending = "reached" if self.succeeded else "aborted"
        return _because(f"goal {self.goal} {ending}", self.reason)


@dataclass(frozen=True, slots=True)
class TaskRequested(Event):
    """Somebody submits a task."""

    kind = "task.requested"
    is_input = True
    is_notable = False

    waypoints: int
    length_m: float
    start_index: int
    controller: str
    speed_mps: float

    @property
    def words(self) -> str:
        """Return what is to be driven."""
        path = f"{self.waypoints} waypoints, {self.length_m:.1f} m"
        return f"task requested: {path} by {self.controller} at {self.speed_mps:g} m/s"


@dataclass(frozen=True, slots=True)
class TaskCancelRequested(Event):
    """Somebody cancels the current task."""

    kind = "task.cancel_requested"
    is_input = True
    is_notable = False

    @property
    def words(self) -> str:
        """Return that the task shall end."""
        return "cancel of the task requested"


@dataclass(frozen=True, slots=True)
class TaskServed(Event):
    """A task is accepted as the current one."""

    kind = "task.served"

    task: TaskId
    waypoints: int
    length_m: float

    @property
    def words(self) -> str:
        """Return how long the accepted task is."""
        return f"task {self.task} accepted, {self.length_m:.1f} m"


@dataclass(frozen=True, slots=True)
class _TaskDriven(Event):
    """Navigation was given a goal of the task."""

    verb: ClassVar[str]

    task: TaskId
    goal: GoalId
    target_index: int

    @property
    def words(self) -> str:
        """Return which task is driven."""
        return f"task {self.task} {self.verb}"


@dataclass(frozen=True, slots=True)
class TaskStarted(_TaskDriven):
    """The task starts to drive."""

    kind = "task.started"
    verb = "started"


@dataclass(frozen=True, slots=True)
class TaskResumed(_TaskDriven):
    """The task resumes from its target index."""

    kind = "task.resumed"
    verb = "resumed"


@dataclass(frozen=True, slots=True)
class _TaskHeld(Event):
    """The task is held."""

    verb: ClassVar[str]

    task: TaskId
    reason: str | None

    @property
    def words(self) -> str:
        """Return why the task is held."""
        return _because(f"task {self.task} {self.verb}", self.reason)


@dataclass(frozen=True, slots=True)
class TaskPausing(_TaskHeld):
    """The task is held, and the vehicle comes to a standstill."""

    kind = "task.pausing"
    verb = "pausing"


@dataclass(frozen=True, slots=True)
class TaskPaused(_TaskHeld):
    """The task is held, and the vehicle is at standstill."""

    kind = "task.paused"
    verb = "paused"


@dataclass(frozen=True, slots=True)
class _TaskEnded(Event):
    """The task ended."""

    phase: ClassVar[TaskPhase]

    task: TaskId
    reason: str | None
    progress: float

    @property
    def words(self) -> str:
        """Return how the task ended, how far it got, and why."""
        ended = f"task {self.task} {self.phase.lower()} at {self.progress:.0%}"
        return _because(ended, self.reason)


@dataclass(frozen=True, slots=True)
class TaskSucceeded(_TaskEnded):
    """The task succeeded: its path was driven to the end."""

    kind = "task.succeeded"
    phase = TaskPhase.SUCCEEDED


@dataclass(frozen=True, slots=True)
class TaskCanceled(_TaskEnded):
    """The task was canceled or replaced."""

    kind = "task.canceled"
    phase = TaskPhase.CANCELED


@dataclass(frozen=True, slots=True)
class TaskAborted(_TaskEnded):
    """The task was aborted, for a reason."""

    kind = "task.aborted"
    phase = TaskPhase.ABORTED


TASK_ENDS: Mapping[TaskPhase, type[_TaskEnded]] = {
    end.phase: end for end in (TaskSucceeded, TaskCanceled, TaskAborted)
}


@dataclass(frozen=True, slots=True)
class HoldRequested(Event):
    """Somebody requests a hold."""

    kind = "hold.requested"
    is_input = True
    is_notable = False

    owner: str
    reason: str

    @property
    def words(self) -> str:
        """Return whose hold is requested, and why."""
        return _because(f"hold {self.owner} requested", self.reason)


@dataclass(frozen=True, slots=True)
class HoldReleaseRequested(Event):
    """Somebody requests that a hold be released."""

    kind = "hold.release_requested"
    is_input = True
    is_notable = False

    owner: str

    @property
    def words(self) -> str:
        """Return whose hold shall go."""
        return f"release of hold {self.owner} requested"


@dataclass(frozen=True, slots=True)
class HoldSet(Event):
    """A hold is set: no task runs until it is released."""

    kind = "hold.set"

    owner: str
    reason: str

    @property
    def words(self) -> str:
        """Return whose hold it is, and why."""
        return _because(f"hold {self.owner} set", self.reason)


@dataclass(frozen=True, slots=True)
class HoldReleased(Event):
    """A hold is released."""

    kind = "hold.released"

    owner: str

    @property
    def words(self) -> str:
        """Return whose hold is gone."""
        return f"hold {self.owner} released"


# --- the service ---------------------------------------------------------------------------------


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

    @property
    def words(self) -> str:
        """Return the request and its status."""
        return f"{self.method} {self.path} from {self.address} answered {self.status}"


@dataclass(frozen=True, slots=True)
class TimeWasDue(Event):
    """A deadline passed, or something was old or bad for long enough."""

    kind = "time.passed"
    is_input = True
    is_notable = False

    @property
    def words(self) -> str:
        """Return that time alone led to what follows."""
        return "a deadline passed"


EVENTS: Mapping[str, type[Event]] = {
    found.kind: found
    for found in sorted(
        (
            item
            for item in list(globals().values())
            if isinstance(item, type) and issubclass(item, Event) and hasattr(item, "kind")
        ),
        key=lambda item: item.kind,
    )
}
"""All kinds by name."""
