"""Which monitors cannot be computed, and which readings go where."""

import pytest

from domain.errors import InvalidValueError
from domain.health.monitor_graph import faults_of_monitors, fed_by, number_of
from domain.health.signals import SignalKind, SignalSettings, SignalSpec, default_signals
from domain.health.state_manager import StateManager
from domain.windows.settings import Statistic
from tests.support.watched_robot import monitor, signal

LOAD = signal()


@pytest.mark.parametrize(
    ("monitors", "fault"),
    [
        ([monitor(Statistic.MEAN, of="laod")], ("of", "UNKNOWN_SIGNAL", "did you mean load?")),
        ([monitor(Statistic.MEAN, of="watched")], ("of", "MONITOR_CYCLE", "watched of watched")),
        (
            [monitor(Statistic.MAX, name="b", of="a"), monitor(Statistic.MIN, name="a", of="b")],
            ("of", "MONITOR_CYCLE", "b of a of b"),
        ),
        (
            [monitor(Statistic.AGE, name="a"), monitor(Statistic.MAX, name="b", of="a")],
            ("of", "NOT_CHAINABLE", "a is the age of a signal"),
        ),
        (
            [monitor(Statistic.MEAN, of="signal_strength")],
            ("statistic", "WRONG_TYPE", "signal_strength is no number: it has no mean"),
        ),
    ],
)
def test_what_cannot_be_computed_is_found(
    monitors: list[SignalSettings], fault: tuple[str, str, str]
) -> None:
    declared = (*default_signals(), LOAD, *monitors)
    key, code, words = fault
    first = next(faults_of_monitors(declared))
    assert (first.key, first.code) == (key, code)
    assert words in first.message
    with pytest.raises(InvalidValueError, match=words.replace("?", ".")):
        StateManager(declared, 0)


@pytest.mark.parametrize("statistic", [Statistic.AGE, Statistic.GAP, Statistic.STUCK_FOR])
def test_what_grows_in_silence_is_no_source(statistic: Statistic) -> None:
    chain = [monitor(statistic, name="a"), monitor(Statistic.MAX, name="b", of="a")]
    assert [fault.code for fault in faults_of_monitors([LOAD, *chain])] == ["NOT_CHAINABLE"]


@pytest.mark.parametrize("statistic", [Statistic.RATE, Statistic.COUNT, Statistic.SLOPE])
def test_the_others_can_be_chained(statistic: Statistic) -> None:
    chain = [monitor(statistic, name="a"), monitor(Statistic.MAX, name="b", of="a")]
    assert list(faults_of_monitors([LOAD, *chain])) == []


def test_a_monitor_beside_a_circle_is_not_in_it() -> None:
    circle = [monitor(Statistic.MAX, name="b", of="a"), monitor(Statistic.MIN, name="a", of="b")]
    beside = monitor(Statistic.MAX, name="c", of="a")
    assert {fault.signal for fault in faults_of_monitors([*circle, beside])} == {"a", "b"}


def test_readings_go_to_the_monitors_of_their_signal() -> None:
    first, second = monitor(Statistic.MAX, name="a"), monitor(Statistic.MIN, name="b")
    chained = monitor(Statistic.MEAN, name="c", of="a")
    assert fed_by([LOAD, first, second, chained]) == {"load": ("a", "b"), "a": ("c",)}


def test_every_value_is_a_number_to_a_window() -> None:
    word = SignalSpec("mode", SignalKind.ENUMERATION, members=("GOOD", "BAD"))
    assert number_of(word, "BAD") == 1.0
    assert number_of(SignalSpec("door", SignalKind.BOOLEAN), True) == 1.0
    assert number_of(LOAD.spec, 2.5) == 2.5
