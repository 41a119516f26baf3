import pytest

from domain.concern import Concern, NotSettledError, Takers, overrides, settle, takers_of


class Restless(Concern):
    """A concern that moves a number of times."""

    def __init__(self, moves: int) -> None:
        self.moves = moves

    def settle(self, now: int) -> bool:
        self.moves -= 1
        return self.moves >= 0


class Taker(Concern):
    """A concern that takes inputs."""

    def __init__(self, takes: Takers) -> None:
        self._takes = takes

    @property
    def takes(self) -> Takers:
        return self._takes


class Shy(Restless):
    """Another one."""


def test_a_concern_that_says_nothing_takes_nothing_and_never_moves() -> None:
    concern = Concern()

    concern.pass_time(7)

    assert concern.takes == {}
    assert concern.wake_at() is None
    assert not concern.settle(7)


def test_concerns_settle_once_none_of_them_moves() -> None:
    first, second = Restless(2), Shy(5)

    settle([first, second], 0, max_rounds=6)

    assert (first.moves, second.moves) == (-4, -1)


def test_no_concern_settles_again_that_has_settled_since_the_last_change() -> None:
    first, second = Restless(1), Shy(0)

    settle([first, second], 0, max_rounds=6)

    assert (first.moves, second.moves) == (-1, -1)


def test_concerns_that_never_settle_are_an_error_that_names_them() -> None:
    with pytest.raises(NotSettledError) as caught:
        settle([Concern(), Restless(10_000), Shy(10_000)], 0, max_rounds=50)

    assert caught.value.moving == ("Restless", "Shy")
    assert str(caught.value) == "not settled after 50 rounds; still changing: Restless, Shy"


def test_the_first_concern_that_takes_an_input_owns_it() -> None:
    calls: list[str] = []

    owner = Taker({int: lambda given, now: calls.append(f"owner {given} at {now}")})
    follower = Taker(
        {
            int: lambda given, now: calls.append("follower"),
            str: lambda given, now: calls.append("other"),
        }
    )

    takers = takers_of([owner, follower])
    for take in takers[int]:
        take(7, 9)

    assert calls == ["owner 7 at 9", "follower"]
    assert len(takers[str]) == 1


def test_a_concern_is_asked_only_for_what_it_has_of_its_own() -> None:
    assert overrides(Restless(0), "settle")
    assert not overrides(Restless(0), "pass_time")
