"""The cut sets of random fault trees are those of a look at every combination of basic events."""

import os
from collections.abc import Mapping

from hypothesis import given, settings
from hypothesis import strategies as st

from domain.analysis.cut_sets import Event, Gate, minimal_cut_sets

TREES = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 300
MAX_BASIC = 12
MAX_GATES = 12


@st.composite
def trees(draw: st.DrawFn) -> tuple[int, dict[Event, Gate]]:
    """Return the number of basic events, and gates each of which is above those before it."""
    basic = draw(st.integers(1, MAX_BASIC))
    gates: dict[Event, Gate] = {}
    for number in range(basic, basic + draw(st.integers(1, MAX_GATES))):
        inputs = draw(st.lists(st.integers(0, number - 1), min_size=1, max_size=6))
        gates[Event(number)] = Gate(tuple(map(Event, inputs)), draw(st.booleans()))
    return basic, gates


@settings(max_examples=TREES, deadline=None)
@given(trees())
def test_cut_sets_are_the_smallest_combinations_that_raise_an_event(
    tree: tuple[int, dict[Event, Gate]],
) -> None:
    basic, gates = tree

    found = minimal_cut_sets(gates, gates)

    for top, smallest in _by_trial(basic, gates).items():
        assert {frozenset(events) for events in found[top].sets} == smallest
        assert len(found[top].sets) == len(smallest)
        assert found[top].order is None


def _by_trial(basic: int, gates: Mapping[Event, Gate]) -> dict[Event, set[frozenset[Event]]]:
    """Raise every combination of basic events, small ones first, and note what is new for a gate.

    A combination raises a gate for the first time if it does so, and none of those with one event
    less does.
    """
    raises: dict[Event, list[bool]] = {top: [] for top in gates}
    smallest: dict[Event, set[frozenset[Event]]] = {top: set() for top in gates}
    for combination in range(1 << basic):
        is_on = {Event(event): bool(combination >> event & 1) for event in range(basic)}
        for top, gate in gates.items():
            inputs = [is_on[event] for event in gate.inputs]
            is_on[top] = all(inputs) if gate.needs_all else any(inputs)
            raises[top].append(is_on[top])
            less = (combination & ~(1 << event) for event in range(basic) if is_on[Event(event)])
            if is_on[top] and not any(raises[top][each] for each in less):
                events = (Event(event) for event in range(basic) if combination >> event & 1)
                smallest[top].add(frozenset(events))
    return smallest
