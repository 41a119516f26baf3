"""Views of the robot at one moment: plain, frozen values, made by the core.

Nothing here refers to a live object, so a snapshot may be kept, compared and sent.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Literal, NamedTuple

from domain.computers import ComputerName, StopView
from domain.findings import Blocker, Fact
from domain.identifiers import ChangeId, TaskId
from domain.inputs import ChangeRequest, SignalValue
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import ParameterValue
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.timebase import Duration, Instant
from domain.vehicle import DriveCommand, Point, VehicleState


class SystemState(StrEnum):
    """State of the whole robot. Source: smart_polaris, `SystemStateStamped.msg`."""

    IDLE = "IDLE"
    RUNNING = "RUNNING"
    ERROR = "ERROR"


class TaskStatus(StrEnum):
    """Whether the robot has a task. Source: smart_polaris, `TaskPlannerStatus.msg`."""

    NO_TASK = "NO_TASK"
    PAUSED_TASK = "PAUSED_TASK"
    RUNNING_TASK = "RUNNING_TASK"


@dataclass(frozen=True, slots=True)
class Actual:
    """Actual state and mode of a part, and how they are known."""

    state: LifecycleState
    mode: ModeName | None = None
    inferred: bool = False
    """The state was inferred (systems) rather than reported."""
    mode_inferred: bool = False
    """The mode was inferred, from parts or from parameters."""
    undecidable: bool = False
    reason: str | None = None
    """Why it is undecidable: the part, and what is not known about it."""
    state_and_mode: StateAndMode = field(init=False, compare=False, repr=False)
    """Both as a pair; made once, since the parts of a robot share most of these objects."""

    def __post_init__(self) -> None:
        """Make the pair."""
        object.__setattr__(self, "state_and_mode", StateAndMode(self.state, self.mode))


class Because(StrEnum):
    """Who set the target in force of a part; each prevails over those before it."""

    REQUESTED = "requested"
    RULE = "rule"
    INVARIANT = "invariant"
    REACTION = "reaction"
    LOCAL = "local"
    """A reaction that acts on the device of its part, where the supervisor only follows it."""


@dataclass(frozen=True, slots=True)
class EffectiveTarget:
    """The target in force, and why it may differ from the requested one."""

    state: LifecycleState
    mode: ModeName | None
    because: Because
    rule: str | None = None
    """Name of the rule that set it; None: no rule did."""
    cause: int | None = None
    """Id of the event that recorded why it differs; None: it is the requested one."""
    blockers: tuple[Blocker, ...] = ()
    """Why the requested target is not in force; empty: it is."""
    reaction: str | None = None
    """Name of the reaction that set it; None: no reaction did."""


@dataclass(frozen=True, slots=True)
class PartView:
    """One system or node."""

    name: PartName
    kind: Literal["system", "node"]
    parts: tuple[PartName, ...]
    target: StateAndMode | None
    effective_target: EffectiveTarget | None
    actual: Actual
    converged: bool
    """Whether it and all its parts are where their targets say."""
    deviation_since: Instant | None
    deviation_reason: str | None
    """Which part is not where its target says; None exactly while `converged`."""
    reachable: bool
    """For a system: whether all its nodes are reachable."""
    change: ChangeId | None
    """The change that drives this part; it may already be superseded elsewhere."""
    device: ComputerName | None = None
    """The computer that owns this node; None: this one."""
    last_known: StateAndMode | None = None
    """Of a node that is unreachable, where it was when it was heard last; None: it is reachable, or
    was never heard, or it is a system."""


@dataclass(frozen=True, slots=True)
class ModeView:
    """One mode of a part, and whether it can be entered now."""

    mode: ModeName
    can_enter: bool
    blockers: tuple[Blocker, ...]
    can_stay: bool | None = None
    """Whether all its invariants hold; None: it is not the mode in force."""
    requires: tuple[str, ...] = ()
    """Conditions of entering it."""
    invariants: tuple[str, ...] = ()
    """Conditions of entering it and of staying in it."""


@dataclass(frozen=True, slots=True)
class ParameterView:
    """One parameter of a node."""

    name: str
    value: ParameterValue | None
    """None: never reported."""
    wanted: ParameterValue | None
    """Value that the target mode requires; None: it requires none."""


class StepStatus(StrEnum):
    """Status of a step of a change."""

    PENDING = "pending"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    TIMED_OUT = "timed_out"
    SUPERSEDED = "superseded"
    CANCELED = "canceled"


class ChangeStatus(StrEnum):
    """Status of a change; all but `waiting` and `running` are final."""

    WAITING = "waiting"
    """It begins once what its modes require is true."""
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    TIMED_OUT = "timed_out"
    SUPERSEDED = "superseded"
    CANCELED = "canceled"

    @property
    def is_final(self) -> bool:
        """Tell whether nothing turns it into another one."""
        return self not in (ChangeStatus.WAITING, ChangeStatus.RUNNING)


class Rollback(StrEnum):
    """What became of going back after a failure."""

    DONE = "done"
    """All parts are where they were."""
    INCOMPLETE = "incomplete"


@dataclass(frozen=True, slots=True)
class StepView:
    """One step of a change: one request to one node."""

    node: PartName
    action: Transition | Literal["set_parameters"]
    status: StepStatus
    started_at: Instant | None
    ended_at: Instant | None
    error: str | None
    stage: int = 0
    """From 0; the nodes of one stage may run side by side."""
    after: tuple[PartName, ...] = ()
    """The nodes that its node waits for, without those that these wait for."""
    expected: Duration | None = None
    """How long it is expected to take; None: it was never done."""
    rollback: bool = False
    """It takes its node back to where it was."""


@dataclass(frozen=True, slots=True)
class PlanView:
    """What a request would do now."""

    steps: Sequence[StepView]
    stages: int
    expected: Duration | None
    """Of all steps, in their order; None: of some it is not known."""


@dataclass(frozen=True, slots=True)
class ChangeView:
    """One change of state, mode or parameters."""

    id: ChangeId
    part: PartName
    request: ChangeRequest
    status: ChangeStatus
    reason: str | None
    steps: Sequence[StepView]
    """Frozen as the rest; each is made when it is read, since there may be thousands."""
    started_at: Instant
    ended_at: Instant | None
    cause: int
    """Id of the event that recorded the request."""
    stage: int = 0
    """The highest stage of which a node has begun."""
    deadline_at: Instant | None = None
    """When it times out as a whole; None: only its steps do."""
    rollback: Rollback | None = None
    """None: it does not go back, or not yet."""


class SignalView(NamedTuple):
    """One signal: the value held, and its evaluation; thousands a second, so a tuple."""

    signal: str
    value: SignalValue | None
    """None: never seen."""
    unit: str
    source: str | None
    received_at: Instant | None
    stamp: Instant | None
    stale: bool
    error: str | None
    """The active error of the value, if any; `stale` tells of staleness."""
    pending_error: str | None
    pending_since: Instant | None
    pending_needs: Duration | None
    skewed: bool
    """The sender's clock differs from ours by more than a second."""
    needs_acknowledgement: bool
    """`error` ends only after an operator has acknowledged it, and nobody has yet."""
    settings: Mapping[str, Fact]
    source_fault: str | None = None
    """Why a source gives no reading; None: none has said so since its last reading."""


@dataclass(frozen=True, slots=True)
class MonitorView:
    """One monitor: what is computed, and which limits are in force."""

    signal: str
    of: str
    statistic: str
    window: Duration | None
    """How long a reading stays in the window; None: until `size` newer ones have come."""
    size: int | None
    filled: float
    """How much of the window has passed, from 0 to 1."""
    value: float | None
    """None: unknown."""
    limits: Mapping[str, float]
    """By `above`, `below` and `clear_threshold`."""
    limits_because: str | None
    """Which of the limits by mode these are; None: they are the same in all modes."""


@dataclass(frozen=True, slots=True)
class SystemStateView:
    """State of the robot with its reasons; error code and state always match."""

    state: SystemState
    error_code: int
    errors: tuple[str, ...]
    reasons: tuple[Blocker, ...]
    task_status: TaskStatus
    storage_fault: str | None = None
    """Why what happens cannot be written down; None: it can."""


class Severity(StrEnum):
    """How bad an error is, by its consequence."""

    WARNING = "warning"
    """Nothing changes."""
    URGENT = "urgent"
    """It needs attention soon."""
    CRITICAL = "critical"
    """The task cannot go on; the robot is in ERROR."""
    FATAL = "fatal"
    """It needs hands; the robot is in ERROR."""

    @property
    def stops_task(self) -> bool:
        """Tell whether an error of this severity sets a bit, and so the robot is in ERROR."""
        return self in (Severity.CRITICAL, Severity.FATAL)


class ErrorState(StrEnum):
    """State of an error. Source: ISA-18.2, states of an alarm."""

    NORMAL = "normal"
    PENDING = "pending"
    """Its condition is met, and not yet for long enough."""
    ACTIVE = "active"
    ACKNOWLEDGED = "acknowledged"
    """Active, and an operator has acknowledged it."""
    LATCHED = "latched"
    """Its cause is gone, and an operator has yet to acknowledge it."""
    RETURNED = "returned"
    """It ended by itself, and nobody has acknowledged that it was there; it is not on."""

    @property
    def is_on(self) -> bool:
        """Tell whether the error is raised."""
        return self in _ARE_ON


_ARE_ON = frozenset({ErrorState.ACTIVE, ErrorState.ACKNOWLEDGED, ErrorState.LATCHED})


class ErrorKey(NamedTuple):
    """Which error: of a part, or of the robot itself."""

    part: PartName | None
    """None: the robot's own."""
    error: str

    @property
    def name(self) -> str:
        """Return its name among all errors, such as `BATTERY_LOW` or `drive_base.UNREACHABLE`."""
        return self.error if self.part is None else f"{self.part}.{self.error}"


@dataclass(frozen=True, slots=True)
class ShelfView:
    """An error is shelved: it is not announced for a time."""

    until: Instant
    reason: str
    by: str


@dataclass(frozen=True, slots=True)
class ErrorMarks:
    """What is told about the announcing of an error; it changes no state, bit or reaction."""

    shelf: ShelfView | None = None
    """None: it is not shelved."""
    suppressed: bool = False
    """The model silences it as things are now."""
    chattering: bool = False
    """It was raised and ended too often of late."""
    calming: Duration | None = None
    """For how long its cause would have to be gone before it clears, to be calm; None: it is
    calm, or nothing is known of that."""

    @property
    def is_silenced(self) -> bool:
        """Tell whether it is shelved or suppressed."""
        return self.suppressed or self.shelf is not None


NO_MARKS = ErrorMarks()


@dataclass(frozen=True, slots=True)
class ErrorView:
    """One error of the robot or of a part."""

    key: ErrorKey
    severity: Severity
    state: ErrorState
    first_out: bool
    """It was raised first since no error was on."""
    message: str
    """What was found; empty while it is normal."""
    value: Fact
    threshold: Fact
    since: Instant | None
    """When it was raised, or when it began to be pending; None: it is normal."""
    count: int
    """How often it was raised, in this run of the service."""
    caused_by: "tuple[ErrorKey, ...]" = ()
    """The errors that explain it: those of its causes that are on, or were last."""
    roots: "tuple[ErrorKey, ...]" = ()
    """The errors that it goes back to through its causes; empty: it is a root itself."""
    hint: str = ""
    """What to do about it; empty: nobody said."""

    ended: Instant | None = None
    """When its cause was gone; None: it is present, or that is not known."""
    marks: ErrorMarks = NO_MARKS

    @property
    def is_root(self) -> bool:
        """Tell whether no other error explains it."""
        return not self.roots

    @property
    def is_open(self) -> bool:
        """Tell whether an operator may want to see it: it is not normal, or it is shelved."""
        return self.state is not ErrorState.NORMAL or self.marks.shelf is not None


@dataclass(frozen=True, slots=True)
class EmergencyStopView:
    """The latch that only a person releases: engaged while a stop is, on any computer."""

    engaged: bool
    by: str | None
    reason: str | None
    since: Instant | None
    standstill_at: Instant | None
    """When the vehicle was first seen at standstill since, or since it was found moving all the
    same; None: not yet, or no vehicle."""
    stops: tuple[StopView, ...] = ()
    """All that are engaged, the oldest first; by, reason and since are those of the first."""
    waits_for: tuple[ComputerName, ...] = ()
    """Computers that were asked to release a stop of theirs, and did not say yet that they did."""
    not_heard: tuple[ComputerName, ...] = ()
    """While it is engaged, computers that cannot be heard: they may not know of it, and their stops
    stay engaged."""


class TaskPhase(StrEnum):
    """Status of a task; the last three are final."""

    RUNNING = "RUNNING"
    PAUSING = "PAUSING"
    """Held; the vehicle is not yet at standstill."""
    PAUSED = "PAUSED"
    SUCCEEDED = "SUCCEEDED"
    CANCELED = "CANCELED"
    ABORTED = "ABORTED"


@dataclass(frozen=True, slots=True)
class TaskView:
    """One waypoint task."""

    id: TaskId
    status: TaskPhase
    controller: str
    speed_mps: float
    """Requested cruise speed."""
    waypoint_count: int
    length_m: float
    """Length of the path from `start_index` to its end."""
    start_index: int
    target_index: int
    """First waypoint that is not yet passed."""
    progress: float
    """Covered share of `length_m`, 0 to 1."""
    distance_m: float
    """Distance covered along the path, from `start_index`."""
    cross_track_error_m: float | None
    """Positive: left of the path. None: the task never ran."""
    reason: str | None
    """Why it is held, or how it ended."""
    created_at: Instant
    ended_at: Instant | None
    cause: int
    """Id of the event that recorded the request."""


@dataclass(frozen=True, slots=True)
class HoldView:
    """One hold: while it is set, no task runs."""

    owner: str
    reason: str
    by: str
    """Who set it; empty: Pilothouse itself."""
    since: Instant


@dataclass(frozen=True, slots=True)
class VehicleView:
    """Pose and motion of the vehicle, and its command."""

    state: VehicleState | None
    """None: never reported."""
    at: Instant | None
    """When `state` was reported."""
    command: DriveCommand
    """The last command."""
    lookahead: Point | None
    """The point that the tracker steers to; None: no task is driving."""
    still_moving: Blocker | None = None
    """The vehicle should stand, and does not or is not known to; None: no such finding."""
