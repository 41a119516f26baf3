from graphlib import CycleError

import pytest

from domain.analysis import cut_sets
from domain.analysis.cut_sets import CutSets, Event, Gate, minimal_cut_sets

A, B, C, D, E, TOP, INNER = map(Event, range(7))


def any_of(*inputs: Event) -> Gate:
    return Gate(inputs)


def all_of(*inputs: Event) -> Gate:
    return Gate(inputs, needs_all=True)


def of_top(gates: dict[Event, Gate]) -> CutSets:
    return minimal_cut_sets(gates, [TOP])[TOP]


def test_each_input_of_an_or_gate_raises_it_alone() -> None:
    assert of_top({TOP: any_of(B, A)}).sets == ((A,), (B,))


def test_the_inputs_of_an_and_gate_raise_it_together() -> None:
    assert of_top({TOP: all_of(B, A)}).sets == ((A, B),)


def test_a_basic_event_is_its_own_cut_set() -> None:
    assert of_top({}).sets == ((TOP,),)


def test_an_event_that_is_enough_alone_is_not_told_together_with_others() -> None:
    assert of_top({TOP: any_of(A, INNER), INNER: all_of(A, B)}).sets == ((A,),)


def test_a_common_cause_of_two_redundant_branches_is_a_single_point_of_failure() -> None:
    left, right = Event(7), Event(8)
    gates = {TOP: all_of(left, right), left: any_of(A, E), right: any_of(B, E)}

    assert of_top(gates).sets == ((E,), (A, B))


def test_an_event_that_is_named_twice_counts_once() -> None:
    assert of_top({TOP: all_of(A, A, B)}).sets == ((A, B),)


def test_small_sets_come_first_and_then_those_of_small_numbers() -> None:
    gates = {TOP: any_of(INNER, Event(7), E), INNER: all_of(B, C), Event(7): all_of(A, D)}

    assert of_top(gates).sets == ((E,), (A, D), (B, C))


def test_gates_may_be_as_deep_as_there_are_errors() -> None:
    gates = {Event(n): any_of(Event(n + 1)) for n in range(5_000)}

    assert minimal_cut_sets(gates, [Event(0)])[Event(0)].sets == ((Event(5_000),),)


def test_two_top_events_share_the_gates_below_them() -> None:
    gates = {TOP: all_of(INNER, C), INNER: any_of(A, B)}

    found = minimal_cut_sets(gates, [INNER, TOP])

    assert list(found) == [INNER, TOP]
    assert found[INNER].sets == ((A,), (B,))
    assert found[TOP].sets == ((A, C), (B, C))


def test_a_gate_that_follows_from_itself_has_no_cut_sets() -> None:
    with pytest.raises(CycleError):
        of_top({TOP: any_of(INNER), INNER: any_of(TOP)})


def redundant(channels: int, causes: int) -> dict[Event, Gate]:
    """Return a top event that needs all channels to fail, each of which has several causes."""
    top, *gates = map(Event, range(channels * causes, channels * causes + channels + 1))
    return {
        top: all_of(*gates),
        **{
            gate: any_of(*map(Event, range(number * causes, (number + 1) * causes)))
            for number, gate in enumerate(gates)
        },
    }


def test_many_cut_sets_are_all_listed() -> None:
    gates = redundant(channels=4, causes=10)
    top = next(iter(gates))

    found = minimal_cut_sets(gates, [top])[top]

    assert len(set(found.sets)) == len(found.sets) == 10_000
    assert found.order is None


def test_of_too_many_cut_sets_it_is_told_up_to_how_many_events_they_are_known() -> None:
    gates = redundant(channels=10, causes=10)  # 10,000,000,000 cut sets of ten events each.
    top = next(iter(gates))

    assert minimal_cut_sets(gates, [top])[top] == CutSets((), order=4)


def test_single_points_of_failure_are_found_among_too_many_cut_sets() -> None:
    gates = redundant(channels=10, causes=10)
    inner, top, alone, pair = next(iter(gates)), Event(200), Event(201), Event(202)
    gates |= {top: any_of(inner, alone, pair), pair: all_of(A, B)}

    assert minimal_cut_sets(gates, [top])[top] == CutSets(((alone,), (A, B)), order=4)


def test_an_event_with_too_many_cut_sets_leaves_others_their_own() -> None:
    gates = redundant(channels=10, causes=10)
    top, other = next(iter(gates)), Event(200)
    gates[other] = all_of(A, B)

    found = minimal_cut_sets(gates, [top, other])

    assert found[other] == CutSets(((A, B),))


def test_the_steps_are_bounded_whatever_the_gates(monkeypatch: pytest.MonkeyPatch) -> None:
    # One less than joining ten and ten takes.
    monkeypatch.setattr(cut_sets, "MAX_STEPS_OF_GATE", 99)
    gates = redundant(channels=2, causes=10)
    top = next(iter(gates))

    assert minimal_cut_sets(gates, [top])[top] == CutSets((), order=0)


def test_all_lists_together_are_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cut_sets, "MAX_LISTED", 3)

    found = minimal_cut_sets({TOP: any_of(A, B), INNER: any_of(C, D)}, [TOP, INNER, E])

    assert [each.order for each in found.values()] == [None, 0, None]
