"""Windows as monitors see them."""

import pickle

import pytest

from domain.windows.settings import MAX_READINGS, Statistic
from tests.support.windows import above, after, below, fill, window

OF_ONE_STATISTIC = {
    Statistic.PERCENTILE: {"q": 95.0},
    Statistic.TIME_TO_LIMIT: {"limit": below(0.0)},
}
ALL = [(statistic, OF_ONE_STATISTIC.get(statistic, {})) for statistic in Statistic]


@pytest.mark.parametrize(("statistic", "settings"), ALL)
def test_nothing_is_known_at_the_start(statistic: Statistic, settings: dict[str, object]) -> None:
    empty = window(statistic, window_s=5.0, **settings)  # type: ignore[arg-type]

    assert empty.value(after(0.0)) is None
    assert empty.filled(after(2.0)) == 0.4


@pytest.mark.parametrize(("statistic", "settings"), ALL)
def test_what_was_asked_before_does_not_matter(
    statistic: Statistic, settings: dict[str, object]
) -> None:
    """A client that looks at a monitor changes nothing that a replay has to know."""
    asked = window(statistic, window_s=3.0, **settings)  # type: ignore[arg-type]
    unasked = window(statistic, window_s=3.0, **settings)  # type: ignore[arg-type]
    for tenth in range(100):
        value = 0.1 * ((7 * tenth) % 23) + tenth
        for filled in (asked, unasked):
            filled.add(after(tenth / 10), value)
        asked.value(after(tenth / 10))
        asked.crosses_at(above(3.0), after(tenth / 10))

    assert asked.value(after(11.0)) == unasked.value(after(11.0))


@pytest.mark.parametrize(("statistic", "settings"), ALL)
def test_it_goes_on_bit_for_bit_after_it_was_stored(
    statistic: Statistic, settings: dict[str, object]
) -> None:
    filled = window(statistic, window_s=3.0, **settings)  # type: ignore[arg-type]
    fill(filled, [(tenth / 10, 1e6 - tenth / 3) for tenth in range(60)])
    restored = pickle.loads(pickle.dumps(filled))

    for tenth in range(60, 90):
        now = after(tenth / 10)
        for each in (filled, restored):
            each.add(now, 1e6 - tenth / 7)
        assert restored.value(now) == filled.value(now)
        assert pickle.dumps(restored) == pickle.dumps(filled)


def test_more_readings_than_memory_holds_make_it_unknown_until_they_would_have_left() -> None:
    filled = window(Statistic.COUNT, window_s=1.0)
    for number in range(MAX_READINGS + 2):
        filled.add(after(1.0) + number, 0.0)

    assert filled.value(after(1.1)) is None
    assert filled.changes_at(after(1.1)) == after(2.0) + 1
    assert filled.crosses_at(above(1.0), after(1.1)) == after(2.0) + 1
    assert filled.value(after(2.0) + 1) == MAX_READINGS


def test_fewer_readings_than_asked_for_are_not_enough() -> None:
    filled = fill(window(Statistic.MEAN, window_s=5.0, min_n=3), [(1.0, 4.0), (2.0, 5.0)])
    assert filled.value(after(2.0)) is None

    filled.add(after(3.0), 6.0)

    assert filled.value(after(3.0)) == 5.0
    assert filled.crosses_at(above(9.0), after(3.0)) == after(6.0)


def test_readings_may_be_there_and_have_no_value_all_the_same() -> None:
    level = window(Statistic.TIME_TO_LIMIT, window_s=5.0, limit=below(0.2))
    assert not level.has_enough(after(0.0))

    fill(level, [(1.0, 0.9), (2.0, 0.9), (3.0, 0.9)])

    assert (level.value(after(3.0)), level.has_enough(after(3.0))) == (None, True)
    assert not level.has_enough(after(7.0))


def test_the_newest_readings_of_a_number_stay_however_old_they_are() -> None:
    filled = fill(window(Statistic.MEAN, window_n=2), [(1.0, 4.0), (2.0, 5.0), (3.0, 7.0)])

    assert filled.value(after(9999.0)) == 6.0
    assert filled.crosses_at(above(9.0), after(9999.0)) is None


def test_a_long_silence_empties_it() -> None:
    filled = fill(window(Statistic.MAX, window_s=5.0), [(1.0, 4.0), (2.0, 5.0)])
    filled.add(after(60.0), 1.0)
    filled.add(after(61.0), 2.0)

    assert filled.value(after(61.0)) == 2.0


def test_to_look_how_full_it_is_lets_no_time_pass() -> None:
    filled = fill(window(Statistic.COUNT, window_s=5.0), [(1.0, 0.0), (2.0, 0.0)])

    assert filled.filled(after(9.0)) == 1.0
    assert filled.value(after(5.5)) == 2.0
