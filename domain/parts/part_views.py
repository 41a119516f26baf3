"""What can be seen of parts, kept as long as it holds, and since when they deviate."""

from collections.abc import Iterable, Mapping

from domain.changes.operations import Changes
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.mode_inference import ModeInference
from domain.snapshot import EffectiveTarget, ParameterView, PartView
from domain.state_and_mode import DEFAULT_MODE, PartName, StateAndMode
from domain.timebase import Instant

_UNKNOWN = StateAndMode(LifecycleState.UNKNOWN)


class PartViews:
    """Views of all parts; the same object is returned until something about the part changes."""

    def __init__(self, inference: ModeInference, changes: Changes, outbox: Outbox) -> None:
        self._inference = inference
        self._model = inference.model
        self._changes = changes
        self._outbox = outbox
        self._views: dict[PartName, PartView] = {}
        self._told: dict[PartName, StateAndMode] = {}
        self._deviates_since: dict[PartName, Instant] = {}
        self._unreachable = set(self._model.nodes)
        self._unreachable_below = dict.fromkeys(self._model.systems, 0)
        for node in self._unreachable:
            for system in self._model.ancestors[node]:
                self._unreachable_below[system] += 1

    def get(self, part: PartName) -> PartView:
        """Return the view of a part that the model has."""
        view = self._views.get(part)
        if view is None:
            view = self._views[part] = self._build(part)
        return view

    def all(self) -> Mapping[PartName, PartView]:
        """Return the views of all parts, systems first."""
        return {part: self.get(part) for part in self._model.parts}

    def parameters(self, node: PartName) -> tuple[ParameterView, ...]:
        """Return the parameters of a node, and what its target mode wants of them."""
        known = self._inference.facts[node].parameters
        target = self._inference.target(node)
        modes = self._model.nodes[node].modes
        active = target is not None and target.state is LifecycleState.ACTIVE
        wanted = modes.get((target.mode if target else None) or DEFAULT_MODE, {}) if active else {}
        names = sorted({*known, *wanted, *modes.get(DEFAULT_MODE, {})})
        return tuple(ParameterView(name, known.get(name), wanted.get(name)) for name in names)

    def note_actuals(self, parts: Iterable[PartName]) -> None:
        """Tell of each part whose actual state or mode is another one than told before."""
        for part in sorted(parts):
            self._outbox.parts.add(part)
            actual = self._inference.actual(part)
            now, was = actual.state_and_mode, self._told.get(part, _UNKNOWN)
            if now == was:
                continue
            self._told[part] = now
            data = {"part": part, "actual": now.label, "was": was.label, "reason": actual.reason}
            self._outbox.emit("part.actual_changed", data)

    def note_reachable(self, node: PartName) -> None:
        """Count a node among those that can be reached or those that cannot; tell a difference."""
        reachable = bool(self._inference.facts[node].reachable)
        if reachable is (node not in self._unreachable):
            return
        if reachable:
            self._unreachable.discard(node)
        else:
            self._unreachable.add(node)
        for system in self._model.ancestors[node]:
            self._unreachable_below[system] += -1 if reachable else 1
        self._outbox.parts |= {node, *self._model.ancestors[node]}
        self._outbox.emit("node.reachable" if reachable else "node.unreachable", {"node": node})

    def settle(self, now: Instant) -> None:
        """Forget the views of parts that changed, and tell where deviations began or ended."""
        for part in sorted(self._outbox.parts):
            self._views.pop(part, None)
            deviates = not self._inference.converged(part)
            if deviates is (part in self._deviates_since):
                continue
            target = self._inference.target(part)
            actual = self._inference.actual(part)
            data = {
                "part": part,
                "target": target.label if target else None,
                "actual": actual.state_and_mode.label,
                "reason": actual.reason,
            }
            if deviates:
                self._deviates_since[part] = now
                self._outbox.emit("part.deviation_began", data)
            else:
                del self._deviates_since[part]
                self._outbox.emit("part.deviation_ended", data)

    def _build(self, part: PartName) -> PartView:
        target = self._inference.target(part)
        system = self._model.systems.get(part)
        return PartView(
            name=part,
            kind="system" if system else "node",
            parts=system.parts if system else (),
            target=target,
            effective_target=(
                EffectiveTarget(target.state, target.mode, "requested") if target else None
            ),
            actual=self._inference.actual(part),
            converged=part not in self._deviates_since,
            deviation_since=self._deviates_since.get(part),
            reachable=(
                self._unreachable_below[part] == 0 if system else part not in self._unreachable
            ),
            change=self._changes.change_of(part),
        )
