"""The ROS 2 node lifecycle as a table, with the ids and labels of `lifecycle_msgs`.

`TRANSITIONS` can be checked line by line against the ROS 2 design page. Everything else in this
module is derived from it.

Source: ROS 2 design, "Managed nodes" (design.ros2.org/articles/node_lifecycle.html), and
`lifecycle_msgs/msg/State` and `Transition`. Modes extend the state `active`: deliverable D4.8,
4.1.1.3.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType


class LifecycleState(StrEnum):
    """A primary or transitional state of a node; the value is the label in ROS 2."""

    UNKNOWN = "unknown"
    UNCONFIGURED = "unconfigured"
    INACTIVE = "inactive"
    ACTIVE = "active"
    FINALIZED = "finalized"
    CONFIGURING = "configuring"
    CLEANING_UP = "cleaningup"
    SHUTTING_DOWN = "shuttingdown"
    ACTIVATING = "activating"
    DEACTIVATING = "deactivating"
    ERROR_PROCESSING = "errorprocessing"

    # That of Enum is written in Python, and tables are keyed by states.
    __hash__ = str.__hash__

    @property
    def id(self) -> int:
        """Return the number of this state in `lifecycle_msgs/msg/State`."""
        return _STATE_IDS[self]

    @property
    def is_primary(self) -> bool:
        """Tell whether a node can remain in this state."""
        return self in PRIMARY_STATES


_STATE_IDS: Mapping[LifecycleState, int] = {
    LifecycleState.UNKNOWN: 0,
    LifecycleState.UNCONFIGURED: 1,
    LifecycleState.INACTIVE: 2,
    LifecycleState.ACTIVE: 3,
    LifecycleState.FINALIZED: 4,
    LifecycleState.CONFIGURING: 10,
    LifecycleState.CLEANING_UP: 11,
    LifecycleState.SHUTTING_DOWN: 12,
    LifecycleState.ACTIVATING: 13,
    LifecycleState.DEACTIVATING: 14,
    LifecycleState.ERROR_PROCESSING: 15,
}

PRIMARY_STATES = frozenset(
    {
        LifecycleState.UNCONFIGURED,
        LifecycleState.INACTIVE,
        LifecycleState.ACTIVE,
        LifecycleState.FINALIZED,
    }
)


class Transition(StrEnum):
    """A transition that can be requested of a node or a system."""

    CONFIGURE = "configure"
    CLEANUP = "cleanup"
    ACTIVATE = "activate"
    DEACTIVATE = "deactivate"
    SHUTDOWN = "shutdown"

    @property
    def goal(self) -> LifecycleState:
        """Return the primary state that this transition leads to on success."""
        return _GOALS[self]


@dataclass(frozen=True, slots=True)
class TransitionRule:
    """One line of the lifecycle table."""

    transition: Transition
    id: int
    """Number in `lifecycle_msgs/msg/Transition`; shutdown has one per start state."""
    start: LifecycleState
    via: LifecycleState
    """The transitional state while the callback of the node runs."""
    success: LifecycleState
    failure: LifecycleState
    """State of the node after its callback reports failure."""


_S = LifecycleState
_T = Transition
TRANSITIONS: tuple[TransitionRule, ...] = (
    #              transition     id  start            via               success          failure
    TransitionRule(_T.CONFIGURE, 1, _S.UNCONFIGURED, _S.CONFIGURING, _S.INACTIVE, _S.UNCONFIGURED),
    TransitionRule(_T.CLEANUP, 2, _S.INACTIVE, _S.CLEANING_UP, _S.UNCONFIGURED, _S.INACTIVE),
    TransitionRule(_T.ACTIVATE, 3, _S.INACTIVE, _S.ACTIVATING, _S.ACTIVE, _S.INACTIVE),
    TransitionRule(_T.DEACTIVATE, 4, _S.ACTIVE, _S.DEACTIVATING, _S.INACTIVE, _S.ACTIVE),
    TransitionRule(_T.SHUTDOWN, 5, _S.UNCONFIGURED, _S.SHUTTING_DOWN, _S.FINALIZED, _S.FINALIZED),
    TransitionRule(_T.SHUTDOWN, 6, _S.INACTIVE, _S.SHUTTING_DOWN, _S.FINALIZED, _S.FINALIZED),
    TransitionRule(_T.SHUTDOWN, 7, _S.ACTIVE, _S.SHUTTING_DOWN, _S.FINALIZED, _S.FINALIZED),
)
"""An error in any callback leads to `errorprocessing` instead; see `ERROR_PROCESSED`."""

ERROR_PROCESSED = LifecycleState.UNCONFIGURED
"""State after `errorprocessing` if the error handling succeeds."""

_GOALS: Mapping[Transition, LifecycleState] = {
    rule.transition: rule.success for rule in TRANSITIONS
}
_RULES: Mapping[tuple[LifecycleState, Transition], TransitionRule] = MappingProxyType(
    {(rule.start, rule.transition): rule for rule in TRANSITIONS}
)
_ARRIVALS: Mapping[LifecycleState, LifecycleState] = {
    rule.via: rule.success for rule in TRANSITIONS
}

_REQUESTS: Mapping[Transition, frozenset[LifecycleState]] = MappingProxyType(
    {
        _T.CONFIGURE: frozenset({_S.UNCONFIGURED, _S.INACTIVE}),
        _T.ACTIVATE: frozenset({_S.UNCONFIGURED, _S.INACTIVE, _S.ACTIVE}),
        _T.DEACTIVATE: frozenset({_S.INACTIVE, _S.ACTIVE}),
        _T.CLEANUP: frozenset({_S.UNCONFIGURED, _S.INACTIVE, _S.ACTIVE}),
        _T.SHUTDOWN: frozenset({_S.UNCONFIGURED, _S.INACTIVE, _S.ACTIVE, _S.FINALIZED}),
    }
)
"""States in which a request is legal: at its goal, or on a path that the request implies.

Activate implies configure; cleanup and shutdown imply deactivate. Configure never deactivates, and
deactivate never configures.
"""


def rule_for(start: LifecycleState, transition: Transition) -> TransitionRule | None:
    """Return the line of the table for `transition` from `start`; None: there is none."""
    return _RULES.get((start, transition))


def arrival(state: LifecycleState) -> LifecycleState:
    """Return the primary state that a node in `state` reaches if nothing fails.

    For a primary state this is the state itself; for `errorprocessing` it is `unconfigured`.
    """
    if state is LifecycleState.ERROR_PROCESSING:
        return ERROR_PROCESSED
    return _ARRIVALS.get(state, state)


def is_legal_request(transition: Transition, start: LifecycleState) -> bool:
    """Tell whether `transition` may be requested of a node in the primary state `start`."""
    return start in _REQUESTS[transition]


def path(start: LifecycleState, goal: LifecycleState) -> tuple[Transition, ...] | None:
    """Return the shortest sequence of transitions between two primary states.

    Shutdown is used only towards `finalized`. Returns None if there is no path, as from
    `finalized`.
    """
    return _PATHS.get((start, goal))


def _paths_from(start: LifecycleState) -> dict[LifecycleState, tuple[Transition, ...]]:
    """Search breadth-first; towards `finalized`, an active node is deactivated first."""
    found: dict[LifecycleState, tuple[Transition, ...]] = {start: ()}
    waiting = deque([start])
    while waiting:
        state = waiting.popleft()
        for rule in TRANSITIONS:
            if rule.start is not state or rule.success in found:
                continue
            if rule.start is _S.ACTIVE and rule.transition is _T.SHUTDOWN:
                continue
            found[rule.success] = (*found[state], rule.transition)
            waiting.append(rule.success)
    return found


_PATHS: Mapping[tuple[LifecycleState, LifecycleState], tuple[Transition, ...]] = MappingProxyType(
    {(start, goal): steps for start in PRIMARY_STATES for goal, steps in _paths_from(start).items()}
)
