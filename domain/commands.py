"""What the core asks of nodes, of the vehicle and of its navigation."""

from dataclasses import dataclass
from typing import TypeAlias

from domain.identifiers import GoalId
from domain.lifecycle import Transition
from domain.parameters import Parameters
from domain.paths.path import Path
from domain.state_and_mode import PartName
from domain.vehicle import DriveCommand


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
