from domain.concern import Concern, NotSettledError


def test_a_concern_that_says_nothing_takes_nothing_and_never_moves() -> None:
    concern = Concern()

    concern.pass_time(7)

    assert concern.takes == {}
    assert concern.wake_at() is None
    assert not concern.settle(7)


def test_who_kept_moving_is_named() -> None:
    error = NotSettledError("Changing", 102)

    assert error.moving == "Changing"
    assert str(error) == "not settled after 102 rounds; still moving: Changing"
