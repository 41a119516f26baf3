"""ROS messages as mappings: times, lifecycle states and transitions, and modes."""

from domain.lifecycle import TRANSITIONS, LifecycleState, Transition, rule_for
from domain.state_and_mode import ModeName
from domain.timebase import NANOSECONDS_PER_SECOND, Instant
from service.clock import Clock, since_epoch
from service.ros.interface.endpoints import Fields


def nanoseconds(clock: Clock, at: Instant) -> int:
    """Return an instant in nanoseconds since 1970; an earlier one is 0."""
    return max(0, since_epoch(clock.wall_time(at)))


def header(clock: Clock, at: Instant) -> Fields:
    """Return a `std_msgs/msg/Header` with an empty `frame_id`."""
    sec, nanosec = divmod(nanoseconds(clock, at), NANOSECONDS_PER_SECOND)
    return {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""}


def state(value: LifecycleState) -> Fields:
    """Return a `lifecycle_msgs/msg/State`."""
    return {"id": value.id, "label": str(value)}


def transition(value: Transition | None, start: LifecycleState) -> Fields:
    """Return a `lifecycle_msgs/msg/Transition`.

    Args:
        value: None: a change of state that is no transition of the standard lifecycle.
        start: Selects one of the three ids of shutdown. If there is no such transition from here,
            since others come first, the first id of the transition is used.
    """
    if value is None:
        return {"id": 0, "label": ""}
    rule = rule_for(start, value) or next(r for r in TRANSITIONS if r.transition is value)
    return {"id": rule.id, "label": str(value)}


def transition_description(value: Transition, start: LifecycleState) -> Fields:
    """Return a `lifecycle_msgs/msg/TransitionDescription`."""
    return {
        "transition": transition(value, start),
        "start_state": state(start),
        "goal_state": state(value.goal),
    }


def transition_event(
    timestamp: int, value: Transition | None, start: LifecycleState, goal: LifecycleState
) -> Fields:
    """Return a `lifecycle_msgs/msg/TransitionEvent`; the timestamp is in nanoseconds since 1970."""
    return {
        "timestamp": timestamp,
        "transition": transition(value, start),
        "start_state": state(start),
        "goal_state": state(goal),
    }


def mode_event(timestamp: int, start: ModeName | None, goal: ModeName | None) -> Fields:
    """Return a `system_modes_msgs/msg/ModeEvent`; no mode is an empty label."""
    return {
        "timestamp": timestamp,
        "start_mode": {"label": start or ""},
        "goal_mode": {"label": goal or ""},
    }
