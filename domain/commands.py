"""Commands of the core to nodes, vehicle and navigation."""

from dataclasses import dataclass
from typing import TypeAlias

from domain.computers import ComputerName, PeerStop, StopId
from domain.identifiers import GoalId
from domain.lifecycle import Transition
from domain.parameters import Parameters
from domain.paths.path import Path
from domain.reaction_terms import ReactionState
from domain.state_and_mode import PartName
from domain.vehicle import DriveCommand, VehicleState


@dataclass(frozen=True, slots=True)
class AskTransition:
    """Ask a node for one lifecycle transition."""

    request: int
    node: PartName
    transition: Transition


@dataclass(frozen=True, slots=True)
class AskParameters:
    """Ask a node to set parameters atomically: all or none."""

    request: int
    node: PartName
    values: Parameters


@dataclass(frozen=True, slots=True)
class AskFacts:
    """Ask a node for its actual state and parameters; it answers with a report."""

    request: int
    node: PartName


@dataclass(frozen=True, slots=True)
class Drive:
    """Drive; valid until the next command, and for 0.5 s at most."""

    command: DriveCommand


@dataclass(frozen=True, slots=True)
class SendGoal:
    """Let navigation follow a path; it answers with feedback and a result."""

    goal: GoalId
    path: Path
    first_index: int
    """Waypoint at which the task began; progress counts from there."""
    start_index: int
    """First waypoint not yet passed; this goal begins there."""
    controller: str
    speed_mps: float
    reached_m: float = 0.0
    """Distance along the path, from waypoint 0, that earlier goals of the task reached, in m."""
    left_out_m: float = 0.0
    """Part of `reached_m` that the vehicle never came near, in m."""
    seen: VehicleState | None = None
    """The vehicle when `reached_m` was noted; None: no earlier goal of the task noted anything.

    Navigation knows more of a goal that it preempted itself; of others, this is all.
    """


@dataclass(frozen=True, slots=True)
class PreemptGoal:
    """Preempt the goal of navigation.

    Until the vehicle is at standstill, navigation steers at a commanded speed of 0.
    """

    goal: GoalId


@dataclass(frozen=True, slots=True)
class TellStops:
    """Tell every other computer of the robot which stops are engaged on this one: all of them."""

    stops: tuple[PeerStop, ...]


@dataclass(frozen=True, slots=True)
class AskRelease:
    """Ask another computer to release stops of its own, which a person saw and released here."""

    computer: ComputerName
    stops: tuple[StopId, ...]


@dataclass(frozen=True, slots=True)
class AnswerOrder:
    """Answer a command of the supervisor; the number of the request is the supervisor's."""

    request: int
    node: PartName
    accepted: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class ActAlone:
    """Tell the link whether this device acts on its own, as `offline` of the robot file says."""

    autonomous: bool


@dataclass(frozen=True, slots=True)
class TellReaction:
    """Tell the supervisor how a reaction stands that this device decides about."""

    part: PartName
    reaction: str
    state: ReactionState
    """Idle, acting or exhausted."""


@dataclass(frozen=True, slots=True)
class StartProcess:
    """Start the process of a node; whoever runs it reports that it runs, or why it does not."""

    node: PartName


@dataclass(frozen=True, slots=True)
class StopProcess:
    """End the process of a node, as politely as its time allows; its end is reported."""

    node: PartName


NodeCommand: TypeAlias = AskTransition | AskParameters | AskFacts
LinkCommand: TypeAlias = TellStops | AskRelease | AnswerOrder | ActAlone | TellReaction
ProcessCommand: TypeAlias = StartProcess | StopProcess
Command: TypeAlias = NodeCommand | Drive | SendGoal | PreemptGoal | LinkCommand | ProcessCommand
