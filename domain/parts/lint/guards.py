"""Guards that never hold, and fallbacks that need what broke."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from domain.conditions.condition import Condition
from domain.conditions.tree import (
    Comparison,
    Node,
    Operator,
    Subject,
    TopicKind,
    comparisons,
    negated,
)
from domain.findings import Finding
from domain.lifecycle import LifecycleState
from domain.parts.lint.demands import Demands, contradict
from domain.parts.lint.possible import PossibleValues
from domain.parts.lint.satisfiable import Satisfiability, equals
from domain.parts.lint.warning import warning
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName, StateAndMode


@dataclass(frozen=True, slots=True)
class _Guard:
    kind: str
    """`requires` or `invariants`."""
    condition: Condition

    @property
    def words(self) -> str:
        return f"{self.kind} {self.condition.text!r}"


class GuardLint:
    """Looks at the guards of the modes of one model."""

    def __init__(
        self,
        model: SmhModel,
        possible: PossibleValues,
        demands: Demands,
        satisfiability: Satisfiability,
    ) -> None:
        self._model = model
        self._satisfiability = satisfiability
        self._possible = possible
        self._demands = demands

    def findings(self, part: PartName, mode: ModeName) -> Iterator[Finding]:
        """Yield warnings about the guards of a mode, and about its fallback."""
        settings = self._model.settings_of(part, mode)
        guards = [_Guard("requires", condition) for condition in settings.requires]
        guards += [_Guard("invariants", condition) for condition in settings.invariants]
        held: list[_Guard] = []
        for guard in [] if self._all_can_hold(part, mode, guards) else guards:
            if self._is_told_by_the_check(guard.condition.root):
                continue
            why = self._why_never(part, mode, guard, held)
            if why is None:
                held.append(guard)
            else:
                message = f"{part} in {mode}: {guard.words} never holds: {why}"
                place = (part, "mode_settings", mode, guard.kind, guard.condition.text)
                yield warning("GUARD_NEVER_HOLDS", message, *place)
        yield from self._fallback(part, mode, settings)

    def _all_can_hold(self, part: PartName, mode: ModeName, guards: Iterable[_Guard]) -> bool:
        """Tell whether nothing is wrong with the guards of a mode, as is usual."""
        roots: list[Node] = []
        for guard in guards:
            roots.append(guard.condition.root)
            if guard.kind == "invariants":
                for below, pair in self._demanded(part, mode, guard.condition):
                    roots.extend(self._possible.facts_of(below, pair))
        return self._can_be_true(roots)

    def _why_never(
        self, part: PartName, mode: ModeName, guard: _Guard, held: list[_Guard]
    ) -> str | None:
        """Return why a guard never holds together with those before it; None: it may."""
        own = guard.condition.root
        if not self._can_be_true([own]):
            return "its comparisons contradict each other"
        other = next((o for o in held if not self._can_be_true([own, o.condition.root])), None)
        if other is not None:
            return f"it contradicts {other.words}"
        if held and not self._can_be_true([own, *(other.condition.root for other in held)]):
            return "it contradicts the other guards together"
        if guard.kind == "invariants":
            for below, pair in self._demanded(part, mode, guard.condition):
                facts = self._possible.facts_of(below, pair)
                if not self._can_be_true([own, *facts]):
                    return f"the mode itself requires {below} to be {pair.label}"
        return None

    def _is_told_by_the_check(self, root: Node) -> bool:
        """Tell whether a condition is one comparison with what the fact can never be."""
        return (
            isinstance(root, Comparison)
            and root.operator not in (Operator.NOT_EQUAL, Operator.NOT_IN)
            and not self._can_be_true([root])
        )

    def _demanded(
        self, part: PartName, mode: ModeName, condition: Condition
    ) -> Iterator[tuple[PartName, StateAndMode]]:
        """Yield what a mode demands of the parts that a condition names, itself included."""
        for below in _parts_named(condition):
            if below in self._model:
                pairs = self._demands.of_mode(part, mode, below)
                if len(pairs) == 1 and not contradict(pairs):
                    yield below, next(iter(pairs))

    def _fallback(
        self, part: PartName, mode: ModeName, settings: ModeSettings
    ) -> Iterator[Finding]:
        fallback = settings.fallback
        if fallback is None or fallback == mode:
            return
        needs = [c.root for c in self._model.settings_of(part, fallback).invariants]
        for broken in settings.invariants:
            reached = self._needs_to_reach(part, fallback, broken)
            if self._implies([*needs, *reached], broken.root):
                message = (
                    f"{part} in {mode}: {fallback} needs {broken.text!r}, too, and cannot replace "
                    f"{mode} while that does not hold"
                )
                yield warning(
                    "FALLBACK_NEEDS_THE_SAME", message, part, "mode_settings", mode, "fallback"
                )
                return

    def _needs_to_reach(
        self, part: PartName, mode: ModeName, condition: Condition
    ) -> Iterator[Comparison]:
        """Yield that the nodes that a mode activates can be reached."""
        for below, pair in self._demanded(part, mode, condition):
            if below in self._model.nodes and pair.state is LifecycleState.ACTIVE:
                subjects = _subjects_of(below, condition)
                yield from (equals(s, True) for s in subjects if s.attribute == "reachable")

    def _implies(self, needs: Iterable[Node], broken: Node) -> bool:
        """Tell whether nothing can meet the needs while a condition is false."""
        needs, against, of = list(needs), negated(broken), self._possible.of
        search = self._satisfiability.can_be_true
        return not search([*needs, against], of) and search(needs, of) and search([against], of)

    def _can_be_true(self, conditions: Iterable[Node]) -> bool:
        possible = self._possible
        return self._satisfiability.can_be_true(conditions, possible.of, possible.follows)


def _parts_named(condition: Condition) -> Iterator[PartName]:
    topics = (leaf.subject.topic for leaf in comparisons(condition.root))
    names = (topic.name for topic in topics if topic.kind is TopicKind.PART)
    return iter(dict.fromkeys(map(PartName, names)))


def _subjects_of(part: PartName, condition: Condition) -> Iterator[Subject]:
    subjects = (leaf.subject for leaf in comparisons(condition.root))
    return (s for s in subjects if s.topic.kind is TopicKind.PART and s.topic.name == part)
