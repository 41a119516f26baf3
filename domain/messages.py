"""What goes into the core and what comes out of it, as values.

An *input* is a fact or a request. Everything that acts on the robot is a *command*; everything that
was decided is an *event*, with the event that caused it.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NewType, TypeAlias

from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters, ParameterValue
from domain.paths.path import Path
from domain.system_model import ModeName, PartName
from domain.timebase import Instant
from domain.vehicle import DriveCommand, Point, VehicleState

ChangeId = NewType("ChangeId", str)
TaskId = NewType("TaskId", str)
GoalId = NewType("GoalId", int)

SignalValue: TypeAlias = bool | float | str
"""Of a boolean, numeric or enumerated signal, in this order."""


# --- facts ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class NodeReport:
    """What a node, or the backend on its behalf, says about it; None: not said this time."""

    node: PartName
    state: LifecycleState | None = None
    mode: ModeName | None = None
    parameters: Parameters | None = None
    """Merged by name into what is known."""
    reachable: bool | None = None
    has_lifecycle: bool | None = None
    """False for a plain node: no lifecycle, it counts as active while it is reachable."""


@dataclass(frozen=True, slots=True)
class NodeAnswer:
    """The answer of a node to a command: taken or refused. Taken is not done; a report is."""

    request: int
    node: PartName
    accepted: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Reading:
    """One value of one signal."""

    signal: str
    value: SignalValue
    stamp: Instant | None = None
    """When the sender took it, moved to our clock; None: the sender did not say."""


@dataclass(frozen=True, slots=True)
class Readings:
    """Readings that arrived together; all are taken, or none is."""

    items: tuple[Reading, ...]
    source: str
    """Who measured: readings of `estop` are kept apart by it, and one cannot release another's."""
    actor: str = ""


@dataclass(frozen=True, slots=True)
class VehicleReport:
    """Where the vehicle is and how it moves, as its localization says."""

    state: VehicleState


@dataclass(frozen=True, slots=True)
class BackendStatus:
    """Whether nodes can be reached at all."""

    available: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class GoalFeedback:
    """How far navigation has come with a goal."""

    goal: GoalId
    target_index: int
    """First waypoint that is not yet passed."""
    distance_m: float
    """Along the path, from its first waypoint to where the vehicle is."""
    cross_track_error_m: float
    """Positive: the vehicle is left of the path."""
    lookahead: Point
    """The point that is steered to."""
    command: DriveCommand
    """What the vehicle was told with this."""
    left_out_m: float = 0.0
    """Of the path behind it, what the vehicle was never near."""


@dataclass(frozen=True, slots=True)
class GoalResult:
    """How navigation ended a goal by itself; a goal that was preempted has none."""

    goal: GoalId
    succeeded: bool
    reason: str = ""
    """Why it was aborted."""


@dataclass(frozen=True, slots=True)
class TimePassed:
    """Nothing but time."""


@dataclass(frozen=True, slots=True)
class WriteRecord:
    """A request from outside that was to change something, and how it was answered."""

    method: str
    path: str
    status: int
    """Of HTTP."""
    address: str
    """Host and port of who asked."""
    actor: str = ""


# --- requests ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ModeRequest:
    """Bring a part into a mode; it is configured and activated on the way if it must be."""

    part: PartName
    mode: str
    actor: str = ""


@dataclass(frozen=True, slots=True)
class TransitionRequest:
    """Bring a part through a lifecycle transition."""

    part: PartName
    transition: Transition
    actor: str = ""


@dataclass(frozen=True, slots=True)
class ParametersRequest:
    """Set parameters of a node, all or none."""

    node: PartName
    values: Mapping[str, ParameterValue]
    actor: str = ""


@dataclass(frozen=True, slots=True)
class CancelRequest:
    """Stop a change: no further step is begun; one in flight is not recalled."""

    change: ChangeId
    actor: str = ""


@dataclass(frozen=True, slots=True)
class EmergencyStopRequest:
    """Engage or release the emergency stop."""

    engaged: bool
    reason: str
    actor: str = ""


@dataclass(frozen=True, slots=True)
class AcknowledgeRequest:
    """Acknowledge an error, so that it may end once its cause is gone."""

    error: str
    actor: str = ""


@dataclass(frozen=True, slots=True)
class TaskRequest:
    """Follow a path, in place of the task that there may be."""

    path: Path
    start_index: int
    """The waypoint to begin with."""
    controller: str
    """Name of a path tracker."""
    speed_mps: float
    """Cruise speed; slower in curves and towards the end."""
    actor: str = ""


@dataclass(frozen=True, slots=True)
class CancelTaskRequest:
    """End the current task, if there is one, and stand still."""

    actor: str = ""


@dataclass(frozen=True, slots=True)
class HoldRequest:
    """Keep the vehicle from driving tasks, until `owner` lets go."""

    owner: str
    reason: str
    actor: str = ""


@dataclass(frozen=True, slots=True)
class ReleaseRequest:
    """Let go of the hold of `owner`; nothing happens if there is none."""

    owner: str
    actor: str = ""


ChangeRequest: TypeAlias = ModeRequest | TransitionRequest | ParametersRequest
DriveRequest: TypeAlias = TaskRequest | CancelTaskRequest | HoldRequest | ReleaseRequest

Input: TypeAlias = (
    NodeReport
    | NodeAnswer
    | Readings
    | VehicleReport
    | BackendStatus
    | GoalFeedback
    | GoalResult
    | TimePassed
    | WriteRecord
    | ChangeRequest
    | CancelRequest
    | EmergencyStopRequest
    | AcknowledgeRequest
    | DriveRequest
)


# --- commands ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class AskTransition:
    """Ask a node for one lifecycle transition."""

    request: int
    node: PartName
    transition: Transition


@dataclass(frozen=True, slots=True)
class AskParameters:
    """Ask a node to set parameters, all or none."""

    request: int
    node: PartName
    values: Parameters


@dataclass(frozen=True, slots=True)
class AskFacts:
    """Ask a node for its real state and parameters; it answers with a report."""

    request: int
    node: PartName


@dataclass(frozen=True, slots=True)
class Drive:
    """Drive like this until the next command, and for half a second at most."""

    command: DriveCommand


@dataclass(frozen=True, slots=True)
class SendGoal:
    """Let navigation follow a path from a waypoint on; it says how it goes and how it ends."""

    goal: GoalId
    path: Path
    first_index: int
    """Where the task began; what is covered counts from there."""
    start_index: int
    """First waypoint not yet passed: where this goal begins."""
    controller: str
    speed_mps: float
    reached_m: float = 0.0
    """How far along the path earlier goals of the task came, from waypoint 0."""
    left_out_m: float = 0.0
    """Of that, what the vehicle was never near."""


@dataclass(frozen=True, slots=True)
class PreemptGoal:
    """Let navigation drop its goal; not one command to drive may follow."""

    goal: GoalId


NodeCommand: TypeAlias = AskTransition | AskParameters | AskFacts
Command: TypeAlias = NodeCommand | Drive | SendGoal | PreemptGoal


# --- what comes out ------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Event:
    """Something that was decided or that became known."""

    id: int
    """Rises by one per event."""
    at: Instant
    kind: str
    cause: int | None
    """The event that led to this one; None: it came from outside."""
    actor: str
    data: Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Outputs:
    """What one input led to."""

    commands: tuple[Command, ...] = ()
    events: tuple[Event, ...] = ()
    change: ChangeId | None = None
    """The change that a request began, or that was already there and is met."""
    parts: frozenset[PartName] = frozenset()
    """Parts whose view changed."""
    signals: frozenset[str] = frozenset()
    """Signals whose view changed."""
    system_state: bool = False
    """Whether the system state changed."""
    task: TaskId | None = None
    """The task that a request served."""
    task_changed: bool = False
    """Whether the view of the current task changed, or there is another one or none."""
    vehicle_changed: bool = False
    """Whether the vehicle moves differently, is told something else, or steers to another point."""
