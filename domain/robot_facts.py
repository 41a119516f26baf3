"""The facts that conditions are evaluated over, as the core knows them."""

from collections.abc import Callable
from typing import TypeAlias

from domain.conditions.facts import Observation
from domain.conditions.tree import Comparison, Subject, TopicKind
from domain.findings import Blocker
from domain.health.health import Health
from domain.health.signals import RATIO
from domain.lifecycle import LifecycleState
from domain.parts.parts import Parts
from domain.robot_reasons import RobotReasons
from domain.state_and_mode import PartName
from domain.tasks.driving import Driving

PartErrors: TypeAlias = Callable[[PartName, str], Blocker | None]
"""Returns why an error of a part is active; None: it is not."""

_MISSING = Observation(doubt="does not exist")


class RobotFacts:
    """The facts about one robot; always those of now."""

    def __init__(
        self, parts: Parts, health: Health, driving: Driving, part_errors: PartErrors
    ) -> None:
        """Look at a robot.

        Args:
            parts: States, modes and parameters.
            health: Signals and errors.
            driving: Task, vehicle and holds.
            part_errors: Errors of parts.
        """
        self._parts = parts
        self._health = health
        self._driving = driving
        self._part_errors = part_errors
        self._reasons = RobotReasons(parts, health, driving, part_errors)

    def observe(self, subject: Subject) -> Observation:
        """Return what is known of a subject; one that does not exist is in doubt."""
        kind, name, part = subject.topic
        match kind:
            case TopicKind.SIGNAL:
                return self._signal(name)
            case TopicKind.ERROR:
                return self._error(PartName(part), name) if part else self._robot_error(name)
            case TopicKind.PART:
                return self._part(PartName(name), subject)
            case TopicKind.ROBOT:
                return Observation(self._health.system_state(self._driving.status).state.value)
            case TopicKind.TASK:
                return self._task(subject.attribute)
            case TopicKind.VEHICLE:
                return self._vehicle(subject.attribute)
            case TopicKind.HOLD:
                hold = self._driving.holds.get(name)
                return Observation(hold is not None, since=hold.since if hold else None)

    def why(self, leaf: Comparison) -> tuple[Blocker, ...]:
        """Return why a comparison that is not true is so; empty: nothing explains it further."""
        return self._reasons.why(leaf)

    # --- signals and errors ----------------------------------------------------------------------

    def _signal(self, name: str) -> Observation:
        view = self._health.signals().get(name)
        if view is None:
            return _MISSING
        unit = "" if view.unit == RATIO else view.unit
        if view.value is None:
            return Observation(doubt="was never seen", unit=unit)
        return Observation(view.value, "is stale" if view.stale else "", unit=unit)

    def _robot_error(self, name: str) -> Observation:
        if name not in self._health.errors:
            return Observation(value=False)
        since = [reason.since for reason in self._health.reasons if reason.code == name]
        known = [at for at in since if at is not None]
        return Observation(value=True, since=min(known, default=None))

    def _error(self, part: PartName, name: str) -> Observation:
        if part not in self._parts.model:
            return _MISSING
        reason = self._part_errors(part, name)
        return Observation(reason is not None, since=reason.since if reason else None)

    # --- parts -----------------------------------------------------------------------------------

    def _part(self, part: PartName, subject: Subject) -> Observation:
        if part not in self._parts.model:
            return _MISSING
        match subject.attribute:
            case "reachable":
                return Observation(self._parts.view(part).reachable)
            case "converged":
                view = self._parts.view(part)
                return Observation(view.converged, since=view.deviation_since)
            case "parameters":
                return self._parameter(part, subject.key)
            case attribute:
                return self._state_or_mode(part, attribute)

    def _state_or_mode(self, part: PartName, attribute: str) -> Observation:
        actual = self._parts.inference.actual(part)
        node = self._parts.facts.get(part)
        since = None if node is None else node.state_since
        if actual.state is LifecycleState.UNKNOWN:
            why = f": {actual.reason}" if actual.reason else ""
            if node is not None and attribute == "state":
                return Observation(doubt=node.why_unknown, since=since)
            return Observation(doubt=f"is unknown{why}", since=since)
        if attribute == "state":
            return Observation(actual.state.value, since=since)
        return Observation(actual.mode)

    def _parameter(self, node: PartName, name: str) -> Observation:
        facts = self._parts.facts.get(node)
        if facts is None:
            return Observation(doubt="does not exist: only nodes have parameters")
        if not facts.reachable:
            return Observation(doubt=f"is unknown: {node} {facts.why_unknown}")
        value = facts.parameters.get(name)
        if value is None:
            return Observation(doubt="was never reported")
        if isinstance(value, tuple):
            return Observation(doubt="is an array, which cannot be compared")
        return Observation(value)

    # --- task and vehicle ------------------------------------------------------------------------

    def _task(self, attribute: str) -> Observation:
        if attribute == "status":
            return Observation(self._driving.status.value)
        task = self._driving.current_task
        return Observation(0.0 if task is None else task.progress)

    def _vehicle(self, attribute: str) -> Observation:
        watch = self._driving.watch
        state = watch.state
        if state is None:
            return Observation(doubt="was never reported")
        value, unit = {
            "speed_mps": (state.speed_mps, "m/s"),
            "steering_angle_rad": (state.steering_angle_rad, "rad"),
            "x_m": (state.pose.x_m, "m"),
            "y_m": (state.pose.y_m, "m"),
            "yaw_rad": (state.pose.yaw_rad, "rad"),
        }[attribute]
        return Observation(
            value, "is unknown: the pose is too old" if watch.is_lost else "", unit=unit
        )
