"""Explains a comparison further: the error, the node or the hold that it comes from."""

from collections.abc import Callable, Iterable
from itertools import islice

from domain.conditions.tree import Comparison, TopicKind
from domain.findings import Blocker
from domain.health.health import Health
from domain.parts.node_doubts import doubt_of
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
            case TopicKind.PART if name in self._parts.model.parts:
                found = self._of_part(PartName(name), leaf.subject.attribute)
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

    def _of_part(self, part: PartName, attribute: str) -> Iterable[Blocker]:
        """Return the nodes that keep a part from being where it is needed, or else what deviates.

        A node is not explained by itself: the comparison says already that it is unreachable.
        """
        if attribute == "parameters":
            return ()
        model = self._parts.model
        below = [node for node in model.nodes_below(part) if node != part]
        found = [doubt for node in below if (doubt := self._of_node(part, node, attribute))]
        if found or attribute == "reachable":
            return found
        view = self._parts.view(part)
        if view.deviation_reason is None:
            return ()
        message, since = view.deviation_reason, view.deviation_since
        return (Blocker("DEVIATES", message, (part,), since=since),)

    def _of_node(self, part: PartName, node: PartName, attribute: str) -> Blocker | None:
        facts = self._parts.facts[node]
        if attribute == "reachable" and facts.reachable:
            return None
        return doubt_of(node, facts, self._path(part, node))

    def _path(self, part: PartName, node: PartName) -> tuple[str, ...]:
        """Return one path down from a system to a node below it."""
        model, path, system = self._parts.model, [part], part
        while system in model.systems and node not in model.systems[system].parts:
            system = next(
                child
                for child in model.systems[system].parts
                if child in model.systems and child in model.ancestors[node]
            )
            path.append(system)
        return (*path, node)

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
