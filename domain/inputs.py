"""What goes into the core, as values: facts, and requests."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from domain.actor import NOBODY, Actor
from domain.identifiers import ChangeId, GoalId
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters, ParameterValue
from domain.paths.path import Path
from domain.state_and_mode import ModeName, PartName
from domain.timebase import Instant
from domain.vehicle import DriveCommand, Point, VehicleState

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
    actor: Actor = NOBODY


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
    actor: Actor = NOBODY


# --- requests ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ModeRequest:
    """Bring a part into a mode; it is configured and activated on the way if it must be."""

    part: PartName
    mode: str
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class TransitionRequest:
    """Bring a part through a lifecycle transition."""

    part: PartName
    transition: Transition
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class ParametersRequest:
    """Set parameters of a node, all or none."""

    node: PartName
    values: Mapping[str, ParameterValue]
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class CancelRequest:
    """Stop a change: no further step is begun; one in flight is not recalled."""

    change: ChangeId
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class EmergencyStopRequest:
    """Engage or release the emergency stop."""

    engaged: bool
    reason: str
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class AcknowledgeRequest:
    """Acknowledge an error, so that it may end once its cause is gone."""

    error: str
    actor: Actor = NOBODY


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
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class CancelTaskRequest:
    """End the current task, if there is one, and stand still."""

    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class HoldRequest:
    """Keep the vehicle from driving tasks, until `owner` lets go."""

    owner: str
    reason: str
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class ReleaseRequest:
    """Let go of the hold of `owner`; nothing happens if there is none."""

    owner: str
    actor: Actor = NOBODY


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
