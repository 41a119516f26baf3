"""Modes that no plan reaches: what they demand contradicts itself, or waits for itself."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from typing import TypeAlias

from domain.conditions.tree import Node, Subject, comparisons
from domain.findings import Finding
from domain.parameters import Parameters
from domain.parts.lint.budget import Budget
from domain.parts.lint.possible import PossibleValues
from domain.parts.lint.satisfiable import Satisfiability
from domain.parts.lint.values import Values
from domain.parts.lint.warning import meaning, warning
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName, StateAndMode

_Place: TypeAlias = tuple[PartName, ModeName]
_Modes: TypeAlias = (
    Mapping[ModeName, Parameters] | Mapping[ModeName, Mapping[PartName, StateAndMode]]
)


class PlanLint:
    """Finds the modes that can be entered, beginning with those that need no other one."""

    def __init__(
        self,
        model: SmhModel,
        possible: PossibleValues,
        satisfiability: Satisfiability,
        budget: Budget,
    ) -> None:
        self._model = model
        self._possible = possible
        self._satisfiability = satisfiability
        self._budget = budget
        self._modes: dict[PartName, _Modes] = {
            **{name: system.modes for name, system in model.systems.items()},
            **{name: node.modes for name, node in model.nodes.items()},
        }
        self._reached: dict[PartName, set[ModeName]] = defaultdict(set)
        self._missing: dict[_Place, set[_Place]] = {}
        """The modes that a mode of a system demands, and that are not reached yet."""
        self._waiting: dict[PartName, dict[_Place, None]] = defaultdict(dict)
        """The modes that may become reachable with a mode of a part."""

    def findings(self, conflicts: Mapping[_Place, str]) -> Iterator[Finding]:
        """Yield a warning for each mode that no plan reaches.

        Args:
            conflicts: Modes whose demands contradict each other, and why.
        """
        places = self._places()
        for place in places:
            self._prepare(place)
        self._spread(place for place in places if place not in conflicts)
        for place in places:
            why = conflicts.get(place) or self._why_not(place)
            if why is not None:
                part, mode = place
                message = f"{part}: no plan reaches {mode}: {why}"
                yield warning("UNREACHABLE_MODE", message, part, "modes", mode)

    def _places(self) -> list[_Place]:
        """Return the modes to look at; nodes without settings enter any of theirs."""
        model = self._model
        guarded = [name for name in model.nodes if name in model.mode_settings]
        for name in model.nodes.keys() - model.mode_settings.keys():
            self._reached[name].update(model.nodes[name].modes)
        return [(name, mode) for name in (*model.systems, *guarded) for mode in self._modes[name]]

    def _prepare(self, place: _Place) -> None:
        """Note what a mode waits for."""
        needed = {other for other in self._demanded(place) if not self._is_reached(other)}
        self._missing[place] = needed
        for part in {*(other[0] for other in needed), *self._named(place)}:
            self._waiting[part][place] = None

    def _is_reached(self, place: _Place) -> bool:
        return place[1] in self._reached[place[0]]

    def _demanded(self, place: _Place) -> Iterator[_Place]:
        """Yield the modes that a mode of a system demands of its parts."""
        system = self._model.systems.get(place[0])
        if system is None:
            return
        for child, want in system.modes[place[1]].items():
            mode = meaning(want).mode
            if mode is not None and mode in self._modes[child]:
                yield child, mode

    def _named(self, place: _Place) -> Iterator[PartName]:
        """Yield the parts whose mode the guards of a mode name."""
        for root in self._roots(place):
            for leaf in comparisons(root):
                name = PartName(leaf.subject.topic.name)
                if leaf.subject.attribute == "mode" and name in self._modes:
                    yield name

    def _spread(self, places: Iterable[_Place]) -> None:
        """Add what can be reached, until nothing changes."""
        possible = dict.fromkeys(places)
        pending = dict(possible)
        while pending:
            place, _ = pending.popitem()
            if not self._can_enter(place):
                continue
            part, mode = place
            self._reached[part].add(mode)
            del possible[place]
            for other in list(self._waiting[part]):
                if other in possible:
                    self._missing[other].discard(place)
                    pending[other] = None
                else:
                    del self._waiting[part][other]

    def _can_enter(self, place: _Place) -> bool:
        if self._missing[place] or self._is_transitional(place):
            return False
        roots = self._roots(place)
        return not roots or self._can_be_true(roots)

    def _can_be_true(self, roots: Iterable[Node]) -> bool:
        """Tell whether conditions can be true with the modes that were reached."""
        search, follows = self._satisfiability.can_be_true, self._possible.follows
        return search(roots, self._reachable_values, follows)

    def _is_transitional(self, place: _Place) -> bool:
        system = self._model.systems.get(place[0])
        return system is not None and not all(
            want.state.is_primary for want in system.modes[place[1]].values()
        )

    def _reachable_values(self, subject: Subject) -> Values:
        part = PartName(subject.topic.name)
        if subject.attribute != "mode" or part not in self._modes:
            return self._possible.of(subject)
        reached = self._reached[part]
        self._budget.spend(len(reached))
        return Values.of((*map(str, reached), None))

    def _roots(self, place: _Place) -> list[Node]:
        settings = self._model.settings_of(*place)
        return [condition.root for condition in (*settings.requires, *settings.invariants)]

    def _why_not(self, place: _Place) -> str | None:
        """Return why no plan reaches a mode; None: one does, or another finding says it."""
        if self._is_reached(place) or self._is_transitional(place):
            return None
        missing = self._missing[place]
        if missing:
            part, mode = min(missing)
            return f"it requires {part} to be active.{mode}, which no plan reaches"
        possible, search = self._possible, self._satisfiability.can_be_true
        if not search(self._roots(place), possible.of, possible.follows):
            return None
        return "its guards name modes that cannot be entered before it"
