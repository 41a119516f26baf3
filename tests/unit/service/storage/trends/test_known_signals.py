"""Values and errors as numbers, and what makes a signal the same as before."""

import pytest

from domain.errors import InvalidValueError
from domain.health.signals import default_signals
from service.storage.trends.known_signals import KnownSignals
from service.storage.trends.rows import NO_ERROR
from tests.support.trend_readings import load


def test_a_boolean_counts_as_zero_or_one() -> None:
    estop = KnownSignals(default_signals()).by_name["estop"]

    assert [estop.number_of(value) for value in (False, True)] == [0, 1]
    assert estop.value_of(1.0) == 1.0


def test_a_member_is_its_place_from_good_to_bad() -> None:
    strength = KnownSignals(default_signals()).by_name["signal_strength"]

    assert strength.number_of("NOT_CONNECTED") == 2
    assert strength.value_of(1.0) == "LOW_SIGNAL"


def test_the_more_urgent_error_is_the_worse_one() -> None:
    known = KnownSignals([load()]).by_name["load"]

    assert known.rank_of("LOAD_OVERLOAD") > known.rank_of("LOAD_HEAVY") > known.rank_of(None)


def test_an_error_that_is_declared_no_longer_is_below_all_others_but_is_one() -> None:
    known = KnownSignals([load()]).by_name["load"]

    old, older = known.rank_of("LOAD_ODD"), known.rank_of("LOAD_STRANGE")

    assert NO_ERROR < older < old < known.rank_of("LOAD_HEAVY")
    assert known.rank_of("LOAD_ODD") == old
    assert known.errors_of([NO_ERROR, old, older]) == ["LOAD_ODD", "LOAD_STRANGE"]


def test_a_signal_with_another_unit_is_another_one() -> None:
    kilograms, tons = (KnownSignals([load(unit=unit)]) for unit in ("kg", "t"))

    assert kilograms.identities != tons.identities


def test_signals_of_a_file_that_are_not_declared_get_numbers_too() -> None:
    known, old = KnownSignals([load()]), KnownSignals([load("speed")])

    known.add([*old.identities, *known.identities])

    assert known[1].identity == old.identities[0]
    assert "speed" not in known.by_name


def test_the_settings_of_a_signal_cannot_repeat_a_member() -> None:
    # What the numbers of members rest on.
    with pytest.raises(InvalidValueError, match="duplicate"):
        type(default_signals()[3].spec)(
            "mode", default_signals()[3].spec.kind, members=("A", "B", "A")
        )
