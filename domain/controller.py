"""What an external controller says of the goals that it was sent, and how long it may be silent.

An external controller follows paths in a program of its own. It is trusted with nothing that the
pose of the vehicle does not bear out: see `domain/external_navigation.py`.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

from domain.identifiers import GoalId
from domain.timebase import Duration, seconds


class GoalOutcome(StrEnum):
    """How a controller ended a goal."""

    SUCCEEDED = "succeeded"
    ABORTED = "aborted"
    CANCELED = "canceled"
    UNKNOWN = "unknown"
    """It does not have the goal, as after it was started again."""


@dataclass(frozen=True, slots=True)
class ControllerStatus:
    """Whether there is a controller. One that appears has confirmed that it has no goal left."""

    available: bool
    reason: str = ""
    """Why there is none; empty: there is one."""


@dataclass(frozen=True, slots=True)
class ControllerAnswer:
    """The controller accepts or rejects a goal."""

    goal: GoalId
    accepted: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class ControllerFeedback:
    """What the controller says of its progress."""

    goal: GoalId
    target_index: int
    """First waypoint that is not yet passed."""
    progress: float
    """Share of the path that was driven, 0 to 1."""


@dataclass(frozen=True, slots=True)
class ControllerResult:
    """The controller has ended a goal: it does not drive any more."""

    goal: GoalId
    end: GoalOutcome
    reason: str = ""


ControllerMessage: TypeAlias = (
    ControllerStatus | ControllerAnswer | ControllerFeedback | ControllerResult
)


@dataclass(frozen=True, slots=True)
class NavigationStatus:
    """Whether goals can be driven. Without such a report, they can."""

    available: bool
    reason: str = ""
    """Why they cannot; empty: they can."""


@dataclass(frozen=True, slots=True)
class ControllerSettings:
    """Deadlines of an external controller, and how exact it must be."""

    name: str
    """For a person, such as `/navigate_waypoints`."""
    accepted_within: Duration = seconds(1.0)
    """A goal has to be accepted or rejected."""
    silent_for: Duration = seconds(1.0)
    """So long a goal may be driven without feedback."""
    taken_back_within: Duration = seconds(1.0)
    """The end of a goal has to be confirmed after it was taken back and the vehicle braked."""
    stands_within: Duration = seconds(3.0)
    """The vehicle has to stand after a goal was said to be reached."""
    end_tolerance_m: float = 0.5
    """Largest distance to the last waypoint, m, of a vehicle that arrived."""
    claim_tolerance_m: float = 5.0
    """How far ahead of the vehicle a waypoint may be, m, that is said to be passed."""
