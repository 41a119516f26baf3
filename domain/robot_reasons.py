"""Explains a comparison further: the error, the node or the hold that it comes from."""

from collections.abc import Callable, Iterable, Iterator
from itertools import islice

from domain.conditions.tree import Comparison, Operator, TopicKind
from domain.findings import Blocker
from domain.health.health import Health
from domain.lifecycle import LifecycleState
from domain.parts.node_doubts import IN_DOUBT, doubt_of
from domain.parts.parts import Parts
from domain.snapshot import HoldView, TaskStatus
from domain.state_and_mode import PartName
from domain.tasks.driving import Driving
from domain.tasks.holds import ERROR_HOLD

MAX_CAUSES = 20
"""Largest number of causes of one comparison; more would not be read."""


class RobotReasons:
    """Finds reasons in the facts about one robot."""

    def __init__(
        self,
        parts: Parts,
        health: Health,
        driving: Driving,
        part_errors: Callable[[PartName, str], Blocker | None],
    ) -> None:
        self._parts = parts
        self._health = health
        self._driving = driving
        self._part_errors = part_errors

    def why(self, leaf: Comparison) -> tuple[Blocker, ...]:
        """Return why a comparison that is not true is so; empty: nothing explains it further."""
        kind, name, part = leaf.subject.topic
        match kind:
            case TopicKind.ERROR if part:
                reason = self._part_errors(PartName(part), name)
                found: Iterable[Blocker] = (reason,) if reason else ()
            case TopicKind.ERROR:
                found = (reason for reason in self._health.reasons if reason.code == name)
            case TopicKind.PART if name in self._parts.model:
                found = self._of_part(PartName(name), leaf)
            case TopicKind.ROBOT:
                found = self._health.reasons
            case TopicKind.TASK:
                found = self._of_task()
            case TopicKind.HOLD:
                hold = self._driving.holds.get(name)
                found = (self._of_hold(hold),) if hold else ()
            case _:
                found = ()
        return tuple(islice(found, MAX_CAUSES))

    def _of_part(self, part: PartName, leaf: Comparison) -> Iterable[Blocker]:
        """Return the nodes that keep a part from being where it is needed, or else what deviates.

        A node is not explained by itself: the comparison says already that it is unreachable. A
        part that should not be where it is has no further reason, unless it is unknown.
        """
        attribute, view = leaf.subject.attribute, self._parts.view(part)
        is_unknown = view.actual.state is LifecycleState.UNKNOWN
        should_not = leaf.operator in (Operator.NOT_EQUAL, Operator.NOT_IN)
        if attribute == "parameters" or (should_not and not is_unknown):
            return ()
        found = list(islice(self._doubts_below(part, attribute), MAX_CAUSES))
        if found or attribute == "reachable" or view.deviation_reason is None:
            return found
        message, since = view.deviation_reason, view.deviation_since
        return (Blocker("DEVIATES", message, (part,), since=since),)

    def _doubts_below(self, part: PartName, attribute: str) -> Iterator[Blocker]:
        for node in self._parts.model.nodes_below(part):
            facts = self._parts.facts[node]
            if node == part or facts.known_state not in IN_DOUBT:
                continue
            if attribute == "reachable" and facts.reachable:
                continue
            doubt = doubt_of(node, facts, self._parts.model.path_down(part, node))
            if doubt is not None:
                yield doubt

    def _of_task(self) -> Iterable[Blocker]:
        if self._driving.status is not TaskStatus.PAUSED_TASK:
            return ()
        return [self._of_hold(hold) for hold in self._driving.holds.values()]

    def _of_hold(self, hold: HoldView) -> Blocker:
        by = f", set by {hold.by}" if hold.by else ""
        reason = f": {hold.reason}" if hold.reason else ""
        causes = self._health.reasons[:MAX_CAUSES] if hold.owner == ERROR_HOLD else ()
        return Blocker(
            "HOLD",
            f"hold {hold.owner}{by}{reason}",
            (),
            since=hold.since,
            root_cause=not causes,
            causes=causes,
        )
