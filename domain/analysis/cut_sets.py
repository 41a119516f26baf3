"""Minimal cut sets of fault trees: the smallest sets of basic events that raise a top event.

A gate is raised by any or by all of its inputs, so more events never raise less. The trees of one
robot share their gates; the cut sets of each gate are found once, from the basic events upwards.
Sets of events are the bits of whole numbers.

Source: W. E. Vesely et al., Fault Tree Handbook, NUREG-0492, 1981, chapter VII.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from graphlib import TopologicalSorter
from itertools import groupby
from typing import NewType, TypeAlias

Event = NewType("Event", int)
"""Number of an event; small numbers make small sets."""

MAX_CUT_SETS = 10_000
"""Minimal cut sets of one event; of an event that has more, only those of few events are found."""

MAX_LISTED = 100_000
"""Minimal cut sets of all top events together."""

MAX_STEPS = 6_000_000
"""Unions and comparisons of sets for all cut sets, and again for those of few events: about a
second each."""

MAX_STEPS_OF_GATE = MAX_STEPS // 4
"""Unions and comparisons for one gate, so that one does not use up what others need."""


@dataclass(frozen=True, slots=True)
class Gate:
    """An event that follows from others."""

    inputs: tuple[Event, ...]
    needs_all: bool = False
    """It is raised by all inputs together; False: by any of them."""


@dataclass(frozen=True, slots=True)
class CutSets:
    """The minimal cut sets of a top event, those of few events first."""

    sets: tuple[tuple[Event, ...], ...]
    order: int | None = None
    """None: these are all of them. Else there are too many, and these are all of at most so many
    events."""


_Family: TypeAlias = tuple[int, ...]
"""Sets none of which contains another one, those of few events first."""


def minimal_cut_sets(gates: Mapping[Event, Gate], tops: Iterable[Event]) -> dict[Event, CutSets]:
    """Return the minimal cut sets of events.

    Args:
        gates: The events that follow from others; every other event is basic.
        tops: The events whose cut sets are wanted.

    Raises:
        CycleError: A gate follows from itself.
    """
    wanted = tuple(dict.fromkeys(tops))
    order = _inputs_first(gates, wanted)
    families = _Pass(gates, None, _Budget()).families(order)
    room = MAX_LISTED
    found: dict[Event, CutSets] = {}
    too_many: list[Event] = []
    for top in wanted:
        family = families[top]
        if family is None or len(family) > room:
            too_many.append(top)
        else:
            room -= len(family)
            found[top] = CutSets(_as_events(family))
    found |= _of_few_events(gates, too_many, room)
    return {top: found[top] for top in wanted}


def _inputs_first(gates: Mapping[Event, Gate], tops: Iterable[Event]) -> list[Event]:
    """Return the events that the tops follow from and the tops, each after its inputs."""
    reached: dict[Event, tuple[Event, ...]] = {}
    waiting = list(tops)
    while waiting:
        event = waiting.pop()
        if event not in reached:
            reached[event] = gates[event].inputs if event in gates else ()
            waiting.extend(reached[event])
    return list(TopologicalSorter(reached).static_order())


def _of_few_events(
    gates: Mapping[Event, Gate], tops: Iterable[Event], room: int
) -> dict[Event, CutSets]:
    """Return the cut sets of one event, of up to two, and so on, as far as they can be found.

    Args:
        gates: The events that follow from others.
        tops: Events of which not all cut sets can be found.
        room: How many cut sets may be listed.
    """
    found = {top: CutSets((), 0) for top in tops}
    going_on = tuple(found)
    budget = _Budget()
    size = 0
    while going_on:
        size += 1
        families = _Pass(gates, size, budget).families(_inputs_first(gates, going_on))
        for top in going_on:
            family = families[top]
            more = 0 if family is None else len(family) - len(found[top].sets)
            if family is not None and more <= room:
                room -= more
                found[top] = CutSets(_as_events(family), size)
        going_on = tuple(top for top in going_on if found[top].order == size)
    return found


class _TooManyError(Exception):
    """A gate has too many cut sets, or finding them takes too many steps."""


class _Budget:
    """Steps that are left for several gates."""

    def __init__(self) -> None:
        self._left = MAX_STEPS
        self._left_of_gate = MAX_STEPS_OF_GATE

    def begin_gate(self) -> None:
        """Begin another gate."""
        self._left_of_gate = MAX_STEPS_OF_GATE

    def spend(self, steps: int) -> None:
        """Count steps that are to be done.

        Raises:
            _TooManyError: They are not left.
        """
        if steps > min(self._left, self._left_of_gate):
            raise _TooManyError
        self._left -= steps
        self._left_of_gate -= steps


class _Pass:
    """One pass over all gates, for cut sets of any size or of few events."""

    def __init__(self, gates: Mapping[Event, Gate], max_size: int | None, budget: _Budget) -> None:
        """Prepare.

        Args:
            gates: The events that follow from others.
            max_size: Most events of a cut set; larger ones are left out. None: any number.
            budget: The steps that it may take.
        """
        self._gates = gates
        self._max_size = max_size
        self._budget = budget

    def families(self, order: Iterable[Event]) -> dict[Event, _Family | None]:
        """Return the cut sets of events, each after its inputs; None: there are too many."""
        found: dict[Event, _Family | None] = {}
        for event in order:
            gate = self._gates.get(event)
            if gate is None:
                found[event] = (1 << event,)
                continue
            inputs = [family for each in gate.inputs if (family := found[each]) is not None]
            if len(inputs) < len(gate.inputs):
                found[event] = None
                continue
            self._budget.begin_gate()
            try:
                found[event] = self._all(inputs) if gate.needs_all else self._any(inputs)
            except _TooManyError:
                found[event] = None
        return found

    def _any(self, inputs: Sequence[_Family]) -> _Family:
        self._budget.spend(sum(map(len, inputs)))
        return self._minimal({each for family in inputs for each in family})

    def _all(self, inputs: Sequence[_Family]) -> _Family:
        """Return the unions of one set of each input; small inputs first keep the others small."""
        joined: _Family = (0,)
        for family in sorted(set(inputs), key=len):
            self._budget.spend(len(joined) * len(family))
            unions = {one | other for one in joined for other in family}
            if self._max_size is not None:
                unions = {each for each in unions if each.bit_count() <= self._max_size}
            joined = self._minimal(unions)
        return joined

    def _minimal(self, sets: Iterable[int]) -> _Family:
        """Return the sets that contain no other one; those of few events first.

        A set is compared with smaller ones whose lowest event it has.
        """
        kept: list[int] = []
        smaller: dict[int, list[int]] = {}
        """By lowest bit."""
        starts = 0
        """All these bits."""
        for _, of_size in groupby(sorted(sets, key=int.bit_count), key=int.bit_count):
            found = [each for each in of_size if not self._contains_one(each, smaller, starts)]
            if len(kept) + len(found) > MAX_CUT_SETS:
                raise _TooManyError
            kept += found
            for each in found:
                smaller.setdefault(each & -each, []).append(each)
                starts |= each & -each
        return tuple(kept)

    def _contains_one(self, bits: int, others: Mapping[int, Sequence[int]], starts: int) -> bool:
        """Tell whether a set contains one of others.

        Args:
            bits: The set.
            others: By lowest bit.
            starts: All lowest bits of the others.
        """
        left = bits & starts
        self._budget.spend(1)
        while left:
            lowest = left & -left
            left ^= lowest
            starting = others[lowest]
            self._budget.spend(len(starting) + 1)
            if any(bits & other == other for other in starting):
                return True
        return False


def _as_events(family: _Family) -> tuple[tuple[Event, ...], ...]:
    """Return sets in the order of their sizes, then of the numbers of their events."""
    sets = [tuple(_events_of(each)) for each in family]
    return tuple(sorted(sets, key=lambda events: (len(events), events)))


def _events_of(bits: int) -> Iterator[Event]:
    while bits:
        lowest = bits & -bits
        yield Event(lowest.bit_length() - 1)
        bits ^= lowest
