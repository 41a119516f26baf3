"""Modes that no plan reaches: what they demand contradicts itself, or waits for itself."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from typing import TypeAlias

from domain.conditions.tree import Node, Subject, comparisons
from domain.findings import Finding
from domain.parts.lint.demands import Demands, contradict
from domain.parts.lint.possible import PossibleValues
from domain.parts.lint.satisfiable import can_be_true
from domain.parts.lint.values import Values
from domain.parts.lint.warning import meaning, warning
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName

_Place: TypeAlias = tuple[PartName, ModeName]


class PlanLint:
    """Finds the modes that can be entered, beginning with those that need no other one."""

    def __init__(self, model: SmhModel, possible: PossibleValues, demands: Demands) -> None:
        self._model = model
        self._possible = possible
        self._demands = demands
        self._conflicts = self._find_conflicts()
        self._reached: set[_Place] = set()
        self._missing: dict[_Place, set[_Place]] = {}
        """The modes that a mode of a system demands, and that are not reached yet."""
        self._waiting: dict[_Place, list[_Place]] = defaultdict(list)
        """The modes that may become reachable with a mode."""

    def findings(self) -> Iterator[Finding]:
        """Yield a warning for each mode that no plan reaches."""
        places = [(part, mode) for part in self._model.parts for mode in self._model.modes_of(part)]
        for place in places:
            self._prepare(place)
        self._spread(places)
        for part, mode in places:
            why = self._why_not((part, mode))
            if why is not None:
                message = f"{part}: no plan reaches {mode}: {why}"
                yield warning("UNREACHABLE_MODE", message, part, "modes", mode)

    def _find_conflicts(self) -> dict[_Place, str]:
        """Return the modes that demand different things of one part, lowest systems first."""
        parents = Counter(p for s in self._model.systems.values() for p in s.named_parts)
        conflicts: dict[_Place, str] = {}
        for part in (part for part, number in parents.items() if number > 1):
            for name in self._model.ancestors[part]:
                for mode in self._model.systems[name].modes:
                    pairs = self._demands.of_mode(name, mode, part)
                    inherited = any(place in conflicts for place in self._demanded((name, mode)))
                    if contradict(pairs) and not inherited:
                        labels = " and ".join(sorted(pair.label for pair in pairs))
                        why = f"its parts require {part} to be {labels}"
                        conflicts.setdefault((name, mode), why)
        return conflicts

    def _prepare(self, place: _Place) -> None:
        """Note what a mode waits for."""
        needed = set(self._demanded(place))
        self._missing[place] = needed
        for other in needed | set(self._named(place)):
            self._waiting[other].append(place)

    def _demanded(self, place: _Place) -> Iterator[_Place]:
        """Yield the modes that a mode of a system demands of its parts."""
        part, mode = place
        system = self._model.systems.get(part)
        if system is None:
            return
        for child, want in system.modes[mode].items():
            pair = meaning(want)
            if pair.mode is not None and pair.mode in self._model.modes_of(child):
                yield child, pair.mode

    def _named(self, place: _Place) -> Iterator[_Place]:
        """Yield the modes that the guards of a mode name."""
        settings = self._model.settings_of(*place)
        for condition in (*settings.requires, *settings.invariants):
            for leaf in comparisons(condition.root):
                name = PartName(leaf.subject.topic.name)
                if leaf.subject.attribute == "mode" and name in self._model:
                    yield from ((name, mode) for mode in self._model.modes_of(name))

    def _spread(self, places: Iterable[_Place]) -> None:
        """Add what can be reached, until nothing changes."""
        pending = list(places)[::-1]
        while pending:
            place = pending.pop()
            if place not in self._reached and self._can_enter(place):
                self._reached.add(place)
                for other in self._waiting[place]:
                    self._missing[other].discard(place)
                    pending.append(other)

    def _can_enter(self, place: _Place) -> bool:
        is_possible = not self._missing[place] and place not in self._conflicts
        return is_possible and not self._is_transitional(place) and self._guards_can_hold(place)

    def _is_transitional(self, place: _Place) -> bool:
        system = self._model.systems.get(place[0])
        return system is not None and not all(
            want.state.is_primary for want in system.modes[place[1]].values()
        )

    def _guards_can_hold(self, place: _Place) -> bool:
        """Tell whether the guards can hold with the modes that were reached."""
        roots = self._roots(place)
        return not roots or can_be_true(roots, self._reachable_values, self._possible.follows)

    def _reachable_values(self, subject: Subject) -> Values:
        values, part = self._possible.of(subject), PartName(subject.topic.name)
        if subject.attribute != "mode" or part not in self._model:
            return values
        missing = (m for m in self._model.modes_of(part) if (part, m) not in self._reached)
        return values.without(map(str, missing))

    def _roots(self, place: _Place) -> list[Node]:
        settings = self._model.settings_of(*place)
        return [condition.root for condition in (*settings.requires, *settings.invariants)]

    def _why_not(self, place: _Place) -> str | None:
        """Return why no plan reaches a mode; None: one does, or another finding says it."""
        if place in self._reached or self._is_transitional(place):
            return None
        if place in self._conflicts:
            return self._conflicts[place]
        missing = self._missing[place]
        if missing:
            part, mode = min(missing)
            return f"it requires {part} to be active.{mode}, which no plan reaches"
        if not can_be_true(self._roots(place), self._possible.of, self._possible.follows):
            return None
        return "its guards name modes that cannot be entered before it"
