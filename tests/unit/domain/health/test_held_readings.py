from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from domain.health.held_readings import FURTHER_SOURCES, MAX_SOURCES, HeldReadings
from domain.health.signals import SignalSettings, default_signals
from domain.inputs import Reading, SignalValue
from domain.timebase import seconds
from tests.support.tables import table

SETTINGS = {item.spec.name: item for item in default_signals()}
NOW = seconds(1000)


def battery() -> HeldReadings:
    return HeldReadings(SETTINGS["battery_level"])


def estop() -> HeldReadings:
    return HeldReadings(SETTINGS["estop"])


def level(value: float, stamp: int | None = None) -> Reading:
    return Reading("battery_level", value, stamp)


def pressed(value: bool, stamp: int | None = None) -> Reading:
    return Reading("estop", value, stamp)


def test_the_last_reading_counts_whoever_sent_it() -> None:
    held = battery()
    held.take(level(0.9), "pad", NOW)
    held.take(level(0.4), "relay", NOW + 1)

    assert held.value == 0.4
    assert held.newest is not None
    assert held.newest.source == "relay"


def test_a_stop_is_pressed_until_everyone_who_presses_it_lets_go() -> None:
    held = estop()
    held.take(pressed(True), "pad", NOW)
    held.take(pressed(True), "relay", NOW + 1)
    held.take(pressed(False), "pad", NOW + 2)
    assert held.value is True

    held.take(pressed(False), "relay", NOW + 3)
    assert held.value is False


def test_a_stop_names_who_presses_it_the_longest_first() -> None:
    held = estop()
    for source, at in (("relay", 1), ("pad", 2), ("relay", 3)):
        held.take(pressed(True), source, NOW + at)

    assert [(item.source, item.since) for item in held.pressing] == [
        ("relay", NOW + 1),
        ("pad", NOW + 2),
    ]


def test_nothing_is_known_before_the_first_reading() -> None:
    assert (estop().value, estop().newest, battery().value) == (None, None, None)


class Stamps(NamedTuple):
    """Stamps of two readings that arrive one after the other, in ns after now."""

    first: int
    second: int
    behind: int | None = None
    """How much older the second is than the newest; None: it is taken."""


@table(
    {
        "the same stamp": Stamps(first=0, second=0),
        "a newer stamp": Stamps(first=0, second=1),
        "an older stamp": Stamps(first=0, second=-1, behind=1),
        "older than a stamp a second ahead of our clock": Stamps(
            first=seconds(1), second=seconds(1) - 1, behind=1
        ),
        "older than a stamp further ahead, which does not count": Stamps(
            first=seconds(1) + 1, second=0
        ),
    }
)
def test_a_reading_is_outdated_when_its_stamp_is_older_than_the_newest(row: Stamps) -> None:
    held = battery()
    held.take(level(0.9, NOW + row.first), "pad", NOW)

    assert held.behind(level(0.9, NOW + row.second), "pad") == row.behind


def test_a_reading_without_a_stamp_is_never_outdated() -> None:
    held = battery()
    held.take(level(0.9, NOW), "pad", NOW)

    assert held.behind(level(0.9), "pad") is None


def test_readings_without_a_stamp_do_not_hide_the_newest_stamp() -> None:
    held = battery()
    held.take(level(0.9, NOW), "pad", NOW)
    held.take(level(0.9), "pad", NOW + 1)

    assert held.behind(level(0.9, NOW - 5), "pad") == 5


class LateNews(NamedTuple):
    """A value that is held, and two with an older stamp."""

    held: SignalValue
    worse: SignalValue
    better: SignalValue


@pytest.mark.parametrize(
    ("signal", "values"),
    [
        ("battery_level", LateNews(held=0.8, worse=0.79, better=0.81)),
        ("temperature", LateNews(held=20.0, worse=20.1, better=19.9)),
        ("gps_accuracy", LateNews(held=100.0, worse=101.0, better=99.0)),
        ("signal_strength", LateNews(held="LOW_SIGNAL", worse="NOT_CONNECTED", better="CONNECTED")),
    ],
    ids=["battery_level", "temperature", "gps_accuracy", "signal_strength"],
)
def test_late_news_is_taken_only_when_it_is_worse(signal: str, values: LateNews) -> None:
    held = HeldReadings(SETTINGS[signal])
    held.take(Reading(signal, values.held, NOW), "pad", NOW)

    assert held.behind(Reading(signal, values.worse, NOW - 1), "pad") is None
    assert held.behind(Reading(signal, values.held, NOW - 1), "pad") == 1
    assert held.behind(Reading(signal, values.better, NOW - 1), "pad") == 1


def test_late_news_does_not_make_the_newest_stamp_older() -> None:
    held = battery()
    held.take(level(0.9, NOW), "pad", NOW)
    held.take(level(0.4, NOW - 10), "pad", NOW)

    assert held.behind(level(0.9, NOW - 5), "pad") == 5


def test_late_news_of_a_signal_without_errors_is_never_worse() -> None:
    held = HeldReadings(SignalSettings(SETTINGS["battery_level"].spec))
    held.take(level(0.9, NOW), "pad", NOW)

    assert held.behind(level(0.1, NOW - 1), "pad") == 1


def test_pressing_a_stop_is_never_outdated_and_letting_go_can_be() -> None:
    held = estop()
    held.take(pressed(True, NOW), "pad", NOW)

    assert held.behind(pressed(True, NOW - 1), "pad") is None
    assert held.behind(pressed(False, NOW - 1), "pad") == 1


def test_the_stamps_of_two_sources_of_a_stop_are_not_compared() -> None:
    held = estop()
    held.take(pressed(False, NOW), "pad", NOW)

    assert held.behind(pressed(False, NOW - 1), "relay") is None


@pytest.mark.parametrize(
    ("offset", "skewed"),
    [
        (seconds(1), False),
        (seconds(1) + 1, True),
        (-seconds(1), False),
        (-seconds(1) - 1, True),
        (None, False),
    ],
)
def test_a_clock_is_wrong_when_it_differs_by_more_than_a_second(
    offset: int | None, skewed: bool
) -> None:
    held = battery()
    held.take(level(0.9, None if offset is None else NOW + offset), "pad", NOW)

    assert held.newest is not None
    assert held.newest.skewed is skewed


def test_trying_readings_on_a_copy_changes_nothing() -> None:
    held = battery()
    held.take(level(0.9, NOW), "pad", NOW)
    held.copy().take(level(0.2, NOW + 5), "pad", NOW)

    assert held.value == 0.9
    assert held.behind(level(0.9, NOW + 1), "pad") is None


def test_a_sender_that_invents_source_names_cannot_release_a_stop_or_fill_the_memory() -> None:
    held = estop()
    held.take(pressed(True, NOW), "pad", NOW)
    held.take(pressed(False, NOW), "old", NOW)
    for number in range(MAX_SOURCES):
        held.take(pressed(False, NOW), f"invented {number}", NOW)

    assert held.value is True
    # Forgotten: the source that has been quiet for longest, and with it the order of its stamps.
    assert held.behind(pressed(False, NOW - 1), "old") is None
    assert held.behind(pressed(False, NOW - 1), "invented 0") == 1


def test_further_sources_share_one_that_each_of_them_releases() -> None:
    held = estop()
    for number in range(MAX_SOURCES):
        held.take(pressed(True), f"known {number}", NOW)
    for number in range(1_066):
        held.take(pressed(True, NOW + number), f"invented {number}", NOW)
    assert len(held.pressing) == MAX_SOURCES + 1

    held.take(pressed(False, NOW), "invented 7", NOW)
    for number in range(MAX_SOURCES):
        held.take(pressed(False), f"known {number}", NOW)

    assert held.value is False


def test_the_shared_source_is_released_by_its_own_name() -> None:
    held = estop()
    for number in range(MAX_SOURCES + 1):
        held.take(pressed(True), f"invented {number}", NOW)
    for number in range(MAX_SOURCES):
        held.take(pressed(False), f"invented {number}", NOW)
    assert [reading.source for reading in held.pressing] == [FURTHER_SOURCES]

    held.take(pressed(False), FURTHER_SOURCES, NOW)

    assert held.value is False


def test_a_known_sender_that_repeats_false_does_not_release_the_shared_source() -> None:
    held = estop()
    held.take(pressed(False), "mock", NOW)
    for number in range(MAX_SOURCES + 1):
        held.take(pressed(True), f"invented {number}", NOW)
    for number in range(MAX_SOURCES):
        held.take(pressed(False), "mock", NOW)
        held.take(pressed(False), f"invented {number}", NOW)

    assert held.value is True


_SOURCES = st.integers(0, 3 * MAX_SOURCES).map("source {}".format) | st.just(FURTHER_SOURCES)


@given(st.lists(st.tuples(_SOURCES, st.booleans()), max_size=400))
def test_whatever_was_pressed_is_released_by_those_who_pressed_it(
    sent: list[tuple[str, bool]],
) -> None:
    held = estop()
    for source, value in sent:
        held.take(pressed(value), source, NOW)
        assert held.value is True or not value
        assert len(held.pressing) <= 2 * MAX_SOURCES + 1

    for source in {source for source, value in sent if value}:
        assert held.behind(pressed(False, 0), source) is None
        held.take(pressed(False), source, NOW)

    assert held.pressing == ()
