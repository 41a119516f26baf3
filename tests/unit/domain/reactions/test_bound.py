"""How often something may happen."""

from domain.reactions.bound import Bound


def test_it_may_happen_at_once_as_long_as_it_did_not_happen_too_often() -> None:
    bound = Bound(2, window=10)
    assert bound.free_at(5) == 5
    bound.note(5)
    assert bound.free_at(6) == 6


def test_thereafter_it_may_when_the_first_of_those_times_is_long_enough_ago() -> None:
    bound = Bound(2, window=10)
    bound.note(5)
    bound.note(8)

    assert bound.free_at(9) == 15
    assert bound.free_at(15) == 15
    assert bound.free_at(20) == 20


def test_only_the_last_times_count() -> None:
    bound = Bound(2, window=10)
    for now in (0, 10, 20):
        bound.note(now)

    assert bound.free_at(20) == 20
    bound.note(21)
    assert bound.free_at(21) == 30
