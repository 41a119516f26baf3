"""Modes that no plan reaches: what they demand contradicts itself, or waits for itself."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
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
_Wanted: TypeAlias = Mapping[PartName, StateAndMode]
_Modes: TypeAlias = Mapping[ModeName, Parameters] | Mapping[ModeName, _Wanted]


class PlanLint:
    """Finds the modes that plans reach, beginning with those that need no other one.

    A guard can also see a mode of a system that no plan reaches: the system is in it when its parts
    were brought there one by one.
    """

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
        self._guards: dict[_Place, tuple[Node, ...]] = {}
        self._reached: set[_Place] = set()
        self._seen: dict[PartName, set[ModeName]] = defaultdict(set)
        """The modes of each part that a guard can see."""
        self._unreached: dict[_Place, set[_Place]] = {}
        """The modes that a mode of a system demands, and that are not reached yet."""
        self._unseen: dict[_Place, set[_Place]] = {}
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
            modes = model.nodes[name].modes
            self._seen[name].update(modes)
            self._reached.update((name, mode) for mode in modes)
        return [(name, mode) for name in (*model.systems, *guarded) for mode in self._modes[name]]

    def _prepare(self, place: _Place) -> None:
        """Note what a mode waits for."""
        needed = {other for other in self._demanded(place) if other not in self._reached}
        self._unreached[place] = needed
        self._unseen[place] = set(needed)
        for part in {*(other[0] for other in needed), *self._named(place)}:
            self._waiting[part][place] = None

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
        for root in self._all_roots(place):
            for leaf in comparisons(root):
                name = PartName(leaf.subject.topic.name)
                if leaf.subject.attribute == "mode" and name in self._modes:
                    yield name

    def _spread(self, places: Iterable[_Place]) -> None:
        """Add what can be reached and seen, until nothing changes; all, if that takes too long."""
        possible = dict.fromkeys(place for place in places if not self._is_transitional(place))
        pending = dict(possible)
        while pending:
            if self._budget.is_spent:
                self._reached.update(possible)
                return
            place, _ = pending.popitem()
            part, mode = place
            is_seen = mode in self._seen[part] or self._can_be_seen(place)
            is_reached = self._can_be_reached(place)
            if is_seen and mode not in self._seen[part]:
                self._seen[part].add(mode)
            elif not is_reached:
                continue
            if is_reached:
                self._reached.add(place)
                self._seen[part].add(mode)
                del possible[place]
            self._tell_waiting(place, possible, pending)

    def _tell_waiting(
        self, place: _Place, possible: Mapping[_Place, None], pending: dict[_Place, None]
    ) -> None:
        """Look again at what waits for a part one of whose modes is seen or reached now."""
        waiting = self._waiting[place[0]]
        self._budget.spend(len(waiting))
        for other in list(waiting):
            if other not in possible:
                del waiting[other]
                continue
            self._unseen[other].discard(place)
            if place in self._reached:
                self._unreached[other].discard(place)
            pending[other] = None

    def _can_be_seen(self, place: _Place) -> bool:
        """Tell whether a system can be in a mode, however its parts were brought there."""
        return place[0] in self._model.systems and not self._unseen[place]

    def _can_be_reached(self, place: _Place) -> bool:
        """Tell whether a request can be taken: all guards of what it demands hold at once."""
        if self._unreached[place]:
            return False
        roots = self._all_roots(place)
        return not roots or self._can_be_true(place, roots)

    def _can_be_true(self, place: _Place, roots: Iterable[Node]) -> bool:
        """Tell whether guards can hold with the modes that are seen before the mode itself."""

        def values(subject: Subject) -> Values:
            part = PartName(subject.topic.name)
            if subject.attribute != "mode" or part not in self._modes:
                return self._possible.of(subject)
            seen = self._seen[part]
            self._budget.spend(len(seen))
            return Values.of((*(str(mode) for mode in seen if (part, mode) != place), None))

        return self._satisfiability.can_be_true(roots, values, self._possible.follows)

    def _is_transitional(self, place: _Place) -> bool:
        system = self._model.systems.get(place[0])
        return system is not None and not all(
            want.state.is_primary for want in system.modes[place[1]].values()
        )

    def _roots(self, place: _Place) -> list[Node]:
        settings = self._model.settings_of(*place)
        return [condition.root for condition in (*settings.requires, *settings.invariants)]

    def _all_roots(self, place: _Place) -> tuple[Node, ...]:
        """Return the guards of a mode and of all modes that it demands; effort as its result."""
        known = self._guards.get(place)
        if known is None:
            below = (self._all_roots(other) for other in self._demanded(place))
            known = tuple(dict.fromkeys((*self._roots(place), *chain.from_iterable(below))))
            self._budget.spend(len(known))
            self._guards[place] = known if not self._budget.is_spent else ()
        return known

    def _why_not(self, place: _Place) -> str | None:
        """Return why no plan reaches a mode; None: one does, or another finding says it."""
        if place in self._reached or self._is_transitional(place):
            return None
        unreached = self._unreached[place]
        if unreached:
            part, mode = min(unreached)
            return f"it requires {part} to be active.{mode}, which no plan reaches"
        possible, search = self._possible, self._satisfiability.can_be_true
        if not search(self._roots(place), possible.of, possible.follows):
            return None
        if not search(self._all_roots(place), possible.of, possible.follows):
            return "its guards and those of the modes that it requires contradict each other"
        return "its guards name modes that cannot be entered before it"
