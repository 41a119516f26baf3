"""Errors that come and go: when that is too often, and what would calm it."""

import pytest

from domain.health.chatter import WITHIN, Chatter
from domain.health.turns import Turn
from domain.snapshot import ErrorKey
from domain.timebase import seconds

KEY = ErrorKey(None, "BATTERY_LOW")
OTHER = ErrorKey(None, "GPS_LOST")


def flapping(times: int, on_s: float = 1.0, off_s: float = 2.0) -> Chatter:
    """Return what is known after an error was raised and ended, both counted, so often."""
    chatter = Chatter()
    at_s = 0.0
    for number in range(times):
        raised = number % 2 == 0
        chatter.note(Turn(KEY, raised, seconds(at_s)))
        at_s += on_s if raised else off_s
    return chatter


@pytest.mark.parametrize(("turns", "chatters"), [(5, False), (6, True), (7, True)])
def test_more_than_five_turns_are_too_many(turns: int, *, chatters: bool) -> None:
    assert (flapping(turns).find(KEY) is not None) is chatters


def test_forty_flaps_in_an_hour_are_too_many() -> None:
    chatter = flapping(80, on_s=30.0, off_s=60.0)
    found = chatter.find(KEY)
    assert found is not None
    assert found.calming == seconds(60.1)


def test_six_turns_in_more_than_ten_minutes_are_not() -> None:
    assert flapping(6, on_s=120.0, off_s=120.0).find(KEY) is None


def test_what_would_calm_it_is_longer_than_it_was_ever_off() -> None:
    chatter = flapping(6, off_s=0.05)
    chatter.note(Turn(KEY, True, seconds(10)))
    found = chatter.find(KEY)
    assert found is not None
    longest = 10 - (3 * 1.0 + 2 * 0.05)
    assert seconds(longest) < found.calming <= seconds(longest + 0.1)


def test_it_is_calm_ten_minutes_after_the_turn_that_was_too_many() -> None:
    chatter = flapping(6)
    due = chatter.wake_at()
    assert due == WITHIN
    assert chatter.pop_calm(due - 1) is None
    assert chatter.pop_calm(due) == KEY
    assert chatter.find(KEY) is None
    assert chatter.wake_at() is None


def test_errors_that_are_calm_have_no_deadline() -> None:
    assert flapping(5).wake_at() is None


def test_errors_that_turned_long_ago_are_forgotten() -> None:
    chatter = Chatter()
    for number in range(100):
        chatter.note(Turn(ErrorKey(None, str(number)), True, number))
    for number in range(60):
        chatter.note(Turn(OTHER, number % 2 == 0, WITHIN * (2 + number)))
    assert len(chatter) == 1


def test_what_would_calm_it_counts_from_when_the_cause_was_gone() -> None:
    chatter = Chatter()
    for number in range(6):
        at = seconds(number)
        chatter.note(Turn(KEY, number % 2 == 0, at, None if number % 2 == 0 else at - seconds(0.5)))
    found = chatter.find(KEY)
    assert found is not None
    assert found.calming == seconds(1.6)
