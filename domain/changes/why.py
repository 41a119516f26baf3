"""Why a part is not where it should be."""

from collections.abc import Iterator
from itertools import islice

from domain.actor import NOBODY
from domain.changes.admission import ChangeAdmission
from domain.changes.plan import targets_of
from domain.changes.pursuit import request_towards
from domain.findings import Blocker
from domain.health.health import Health
from domain.parts.node_doubts import doubt_of
from domain.parts.parts import Parts
from domain.state_and_mode import PartName, StateAndMode

DEVIATES = "DEVIATES"
MOST_REASONS = 50
"""Largest number of reasons of one part; more would not be read."""


class Whys:
    """Finds the reasons for one part at a time."""

    def __init__(self, parts: Parts, admission: ChangeAdmission, health: Health) -> None:
        self._parts = parts
        self._admission = admission
        self._health = health

    def of(self, part: PartName) -> tuple[Blocker, ...]:
        """Return why a part is not where it should be, the reasons nearest to it first.

        That is what replaced its requested target; what would block a request for its target in
        force; and each node below that is elsewhere.
        """
        found = [*self._of_target(part), *self._of_request(part)]
        told = {blocker.path[-1] for blocker in found if blocker.path}
        nodes = (each for each in self._of_nodes(part) if each.path[-1] not in told)
        found += islice(nodes, MOST_REASONS)
        if not found:
            found += self._of_itself(part)
        return tuple(sorted(found, key=lambda blocker: len(blocker.path))[:MOST_REASONS])

    def _of_target(self, part: PartName) -> tuple[Blocker, ...]:
        effective, asked = self._parts.view(part).effective_target, self._parts.asked(part)
        if effective is None or asked is None:
            return ()
        is_asked = (effective.state, effective.mode) == (asked.state, asked.mode)
        return () if is_asked else effective.blockers

    def _of_request(self, part: PartName) -> tuple[Blocker, ...]:
        target = self._parts.target(part)
        if target is None or self._parts.inference.converged(part):
            return ()
        model, facts = self._parts.model, self._parts.facts
        request = request_towards(model, facts, part, target, NOBODY)
        return self._admission.blockers(request, self._health.stop_reasons)

    def _of_itself(self, part: PartName) -> Iterator[Blocker]:
        """Yield which system is elsewhere, although all nodes are where they should be.

        So it is if something else was requested of a part below it.
        """
        inference = self._parts.inference
        cause = inference.deviation_cause(part)
        if cause is None or (target := inference.target(cause)) is None:
            return
        message = inference.deviation_reason(part) or ""
        label = inference.actual(cause).state_and_mode.label
        since = self._parts.view(cause).deviation_since
        path = self._parts.model.path_down(part, cause)
        others = tuple(islice(self._asked_elsewhere(cause, target, path), MOST_REASONS))
        yield Blocker(
            DEVIATES,
            message,
            path,
            label,
            target.label,
            since,
            root_cause=not others,
            causes=others,
        )

    def _asked_elsewhere(
        self, system: PartName, target: StateAndMode, path: tuple[PartName, ...]
    ) -> Iterator[Blocker]:
        """Yield the nodes below a system of which something else was requested."""
        model = self._parts.model
        for node, wanted in targets_of(model, system, target).items():
            asked = self._parts.inference.target(node)
            if node not in model.nodes or asked is None or asked == wanted:
                continue
            message = f"the target of {node} is {asked.label}, and {system} needs {wanted.label}"
            below = (*path, *model.path_down(system, node)[1:])
            yield Blocker(DEVIATES, message, below, asked.label, wanted.label)

    def _of_nodes(self, part: PartName) -> Iterator[Blocker]:
        """Yield why each node below is elsewhere, in the order of the file."""
        inference = self._parts.inference
        for node in self._parts.model.nodes_below(part):
            target = inference.target(node)
            if target is None or inference.converged(node):
                continue
            path = self._parts.model.path_down(part, node)
            doubt = doubt_of(node, self._parts.facts[node], path)
            if doubt is not None:
                yield doubt
                continue
            change = self._parts.change_of(node)
            how = f"change {change} is under way" if change else "nothing moves it"
            label = inference.actual(node).state_and_mode.label
            message = f"{node} is {label}, target {target.label}; {how}"
            since = self._parts.view(node).deviation_since
            yield Blocker(DEVIATES, message, path, label, target.label, since)
