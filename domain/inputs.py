"""The inputs of the core: facts and requests."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from domain.actor import NOBODY, Actor
from domain.commands import NodeCommand
from domain.computers import ComputerName, DeviceState, Incarnation, PeerStop, Session, StopId
from domain.controller import ControllerMessage, NavigationStatus
from domain.findings import Fact
from domain.graph_terms import GraphFault
from domain.identifiers import ChangeId, GoalId
from domain.kept import Kept
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters, ParameterValue
from domain.paths.path import Path
from domain.process_terms import ProcessReport, ProcessRequest
from domain.reaction_terms import Arm, ReactionState
from domain.state_and_mode import ModeName, PartName
from domain.timebase import Duration, Instant, seconds
from domain.vehicle import DriveCommand, Point, VehicleState

MAX_SHELF = seconds(8 * 3_600)
"""How long an error may be shelved: a shift. Source: ISA-18.2, shelving is for a limited time."""

SignalValue: TypeAlias = bool | float | str
"""Value of a boolean, numeric or enumerated signal, in this order."""


# --- facts ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class NodeReport:
    """What a node, or the backend on its behalf, reports; None: not part of this report."""

    node: PartName
    state: LifecycleState | None = None
    mode: ModeName | None = None
    parameters: Parameters | None = None
    """Values by name; parameters that are not listed keep their known values."""
    reachable: bool | None = None
    has_lifecycle: bool | None = None
    """False for a plain node, which has no lifecycle and counts as active while reachable."""


@dataclass(frozen=True, slots=True)
class NodeAnswer:
    """A node accepts or rejects a command. Accepted is not done: a report shows the end."""

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
    """When the sender measured, converted to our clock; None: the sender did not say."""


@dataclass(frozen=True, slots=True)
class Readings:
    """Readings that arrived together; all are accepted, or none."""

    items: tuple[Reading, ...]
    source: str
    """Who measured. `estop` is kept per source: one source cannot release another's."""
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class CheckpointReport:
    """A node passes a place in its program that it was asked to report."""

    node: PartName
    checkpoint: str
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class SourceFault:
    """A source gives no reading of a signal; one from the same source ends that."""

    signal: str
    source: str
    """As in `Readings`."""
    reason: str


@dataclass(frozen=True, slots=True)
class VehicleReport:
    """Pose and motion of the vehicle, from its localization."""

    state: VehicleState


@dataclass(frozen=True, slots=True)
class DriveStatus:
    """Whether drive commands reach the vehicle. Without such a report, they do."""

    available: bool
    reason: str = ""
    """Why they do not; empty: they do."""


@dataclass(frozen=True, slots=True)
class BackendStatus:
    """Whether the backend works, so that nodes can be reached at all."""

    available: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class StorageStatus:
    """Whether what happens can be written down. Without such a report, it can."""

    available: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class GoalFeedback:
    """Progress of navigation towards a goal."""

    goal: GoalId
    target_index: int
    """First waypoint that is not yet passed."""
    distance_m: float
    """Distance along the path, from its first waypoint to the vehicle."""
    cross_track_error_m: float
    """Positive: the vehicle is left of the path."""
    lookahead: Point | None
    """The point that the tracker steers to; None: an external controller drives."""
    command: DriveCommand | None
    """The drive command of the same control step; None: an external controller drives."""
    left_out_m: float = 0.0
    """Length of the path behind the vehicle that it never came near, in m."""


@dataclass(frozen=True, slots=True)
class GoalResult:
    """How navigation ended a goal by itself; a preempted goal has no result."""

    goal: GoalId
    succeeded: bool
    reason: str = ""
    """Why it was aborted; empty: it was not."""


@dataclass(frozen=True, slots=True)
class TimePassed:
    """Time passes, and nothing else happens."""


@dataclass(frozen=True, slots=True)
class ServiceStall:
    """The service itself did nothing for a while."""

    late: Duration
    """How much later than planned it went on."""


@dataclass(frozen=True, slots=True)
class WriteRecord:
    """A write request from outside, and the answer."""

    method: str
    path: str
    status: int
    """HTTP status code."""
    address: str
    """Host and port of the client."""
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class DeviceStatus:
    """How the supervisor's connection to a device is; only a change is reported.

    Its nodes are reported before it is connected, and as unreachable after it is lost.
    """

    device: ComputerName
    state: DeviceState
    reason: str = ""
    """Why it is late or not connected, as a sentence; empty: it is connected."""
    incarnation: Incarnation | None = None
    """The run of the device that is, or was last, dealt with; None: none was yet."""
    session: Session | None = None
    version: str | None = None
    """Of Pilothouse there; None: not known."""
    autonomous: bool = False
    """It acts on its own, as `offline` of the robot file says."""
    refused: str = ""
    """Why another process of this name is refused; empty: there is none."""


@dataclass(frozen=True, slots=True)
class SupervisorStatus:
    """How a device's connection to its supervisor is; only a change is reported."""

    state: DeviceState
    reason: str = ""
    """Why it is late or not connected, as a sentence; empty: it is connected."""
    incarnation: Incarnation | None = None


@dataclass(frozen=True, slots=True)
class PeerStops:
    """All emergency stops that are engaged on another computer of the robot, as it says itself.

    What it says holds until it says something else, also while it cannot be heard.
    """

    computer: ComputerName
    stops: tuple[PeerStop, ...]
    ended: tuple[StopId, ...] | None = None
    """Those that ended; what is in neither stays as it was known. None: all but `stops` ended.

    Whoever is not dealt with, or not yet, can engage a stop, but end none except its own.
    """
    is_dealt_with: bool = False
    """Whether the process that is dealt with said so, too."""


@dataclass(frozen=True, slots=True)
class StopsReleased:
    """Somebody at another computer releases stops that are engaged on this one."""

    stops: tuple[StopId, ...]
    """Those that its person saw; any other stays engaged."""
    computer: ComputerName


@dataclass(frozen=True, slots=True)
class ReactionReport:
    """A device tells how a reaction stands that it decides about."""

    part: PartName
    reaction: str
    state: ReactionState
    """Idle, acting or exhausted."""


@dataclass(frozen=True, slots=True)
class OrderReceived:
    """The supervisor has a node of this device do something."""

    command: NodeCommand
    """With the supervisor's number of the request, which the answer repeats."""


# --- requests ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ModeRequest:
    """Bring a part into a mode; this configures and activates it where needed."""

    part: PartName
    mode: str
    actor: Actor = NOBODY
    wait_for: Duration | None = None
    """How long it may wait for what its modes require; None: it is rejected then."""


@dataclass(frozen=True, slots=True)
class TransitionRequest:
    """Request a lifecycle transition of a part."""

    part: PartName
    transition: Transition
    actor: Actor = NOBODY
    wait_for: Duration | None = None
    """How long it may wait for what its modes require; None: it is rejected then."""


@dataclass(frozen=True, slots=True)
class ParametersRequest:
    """Set parameters of a node atomically: all or none."""

    node: PartName
    values: Mapping[str, ParameterValue]
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class CancelRequest:
    """Cancel a change: it starts no further step; a step in flight is not recalled."""

    change: ChangeId
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class EmergencyStopRequest:
    """Engage the emergency stop of this computer, or release stops on all computers."""

    engaged: bool
    reason: str
    actor: Actor = NOBODY
    stops: tuple[StopId, ...] | None = None
    """Those that are released, which a person saw; None: all that are known now."""


@dataclass(frozen=True, slots=True)
class AcknowledgeRequest:
    """Acknowledge an error: somebody has seen it, and it may clear once its cause is gone."""

    error: str
    actor: Actor = NOBODY
    part: PartName | None = None
    """None: the error is the robot's own."""


@dataclass(frozen=True, slots=True)
class ShelveRequest:
    """Do not announce an error for a time; its state, its bit and its reactions stay."""

    error: str
    for_: Duration
    """At most `MAX_SHELF`."""
    reason: str
    actor: Actor = NOBODY
    part: PartName | None = None
    """None: the error is the robot's own."""


@dataclass(frozen=True, slots=True)
class UnshelveRequest:
    """Announce an error again; without effect if it is not shelved."""

    error: str
    actor: Actor = NOBODY
    part: PartName | None = None
    """None: the error is the robot's own."""


@dataclass(frozen=True, slots=True)
class ErrorReport:
    """Somebody found an error of a part that nothing here looks for, or that it is over."""

    part: PartName | None
    """None: of the robot itself, whose errors are all found here; it is rejected."""
    error: str
    active: bool
    message: str = ""
    value: Fact = None
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class ArmRequest:
    """Let a reaction act, only tell when it would, or neither."""

    part: PartName
    reaction: str
    arm: Arm
    reason: str = ""
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class AcknowledgeReactionRequest:
    """Acknowledge a reaction that waits for it, or that acted too often."""

    part: PartName
    reaction: str
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class TaskRequest:
    """Submit a task: follow a path. It replaces the current task, if any."""

    path: Path
    start_index: int
    """Index of the first waypoint to drive to."""
    controller: str
    """Name of a path tracker."""
    speed_mps: float
    """Cruise speed; slower in curves and towards the end."""
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class CancelTaskRequest:
    """Cancel the current task, if any, and stop the vehicle."""

    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class HoldRequest:
    """Set a hold: no task runs until `owner` releases it."""

    owner: str
    reason: str
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class ReleaseRequest:
    """Release the hold of `owner`; without effect if there is none."""

    owner: str
    actor: Actor = NOBODY


@dataclass(frozen=True, slots=True)
class ReportBacklog:
    """Reports and answers of nodes have arrived that are not taken in yet, or all are again."""

    source: str
    """What delivers them; each source has its own backlog."""
    since: Instant | None
    """All that arrived up to then is taken in; None: all that arrived at all."""


@dataclass(frozen=True, slots=True)
class Restored:
    """What an earlier run of the service left; the first input, before any other.

    Nothing that it brings back starts anything: the task is held, and parts wait for a request.
    """

    kept: tuple[Kept, ...] = ()
    boot: int = 1
    """Number of this run, from 1."""
    next_event: int = 1
    """Id of the first event; those before may have been told already."""
    next_change: int = 1
    next_task: int = 1
    stop_because: str = ""
    """Why the emergency stop is engaged, whatever is kept; empty: it is as it was kept."""
    run: str = ""
    """Name of this run, unlike that of any other; empty: it has none."""

    @property
    def is_restart(self) -> bool:
        """Tell whether the service ran before; its first run has nothing to bring back."""
        return self.boot > 1 or bool(self.kept) or bool(self.stop_because)


ChangeRequest: TypeAlias = ModeRequest | TransitionRequest | ParametersRequest
DriveRequest: TypeAlias = TaskRequest | CancelTaskRequest | HoldRequest | ReleaseRequest

Input: TypeAlias = (
    NodeReport
    | NodeAnswer
    | Readings
    | CheckpointReport
    | SourceFault
    | VehicleReport
    | DriveStatus
    | ProcessReport
    | BackendStatus
    | StorageStatus
    | GraphFault
    | ReportBacklog
    | GoalFeedback
    | GoalResult
    | ControllerMessage
    | NavigationStatus
    | TimePassed
    | ServiceStall
    | WriteRecord
    | ChangeRequest
    | CancelRequest
    | EmergencyStopRequest
    | AcknowledgeRequest
    | ErrorReport
    | ArmRequest
    | AcknowledgeReactionRequest
    | ShelveRequest
    | UnshelveRequest
    | ProcessRequest
    | DriveRequest
    | DeviceStatus
    | SupervisorStatus
    | PeerStops
    | StopsReleased
    | ReactionReport
    | OrderReceived
    | Restored
)
