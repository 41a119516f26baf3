"""What a call of the state manager changed."""

from dataclasses import replace

from domain.health.health_changes import NO_MARKS, Gathered, HealthChanges, Marks
from domain.health.signal_monitor import SignalMonitor
from domain.inputs import Reading
from domain.snapshot import ErrorKey
from domain.timebase import seconds
from tests.support.watched_robot import above, signal

HIGH = ErrorKey(None, "HIGH")


def load(value: float, stamp: int | None = None) -> SignalMonitor:
    settings = replace(signal(), bounds=(above(50, for_s=3.0),))
    monitor = SignalMonitor(settings, seconds(10))
    monitor.receive(Reading("load", value, stamp), "test", seconds(10))
    return monitor


def test_a_calm_signal_has_no_marks() -> None:
    assert Marks.of(load(10.0)) is NO_MARKS


def test_marks_are_a_coming_error_and_a_clock_that_is_wrong() -> None:
    assert Marks.of(load(60.0, stamp=seconds(5))) == Marks("HIGH", skewed=True)


def test_a_coming_error_is_pending_until_it_is_told_that_it_is_not() -> None:
    gathered, bad, good = Gathered(), load(60.0), load(10.0)
    gathered.add_signal(NO_MARKS, Marks.of(bad), bad)
    gathered.add_signal(Marks.of(bad), Marks.of(good), good)

    assert gathered.build({HIGH: 0}) == HealthChanges(
        pending=(("load", "HIGH"),),
        settled=(("load", "HIGH", False),),
        signals=frozenset({"load"}),
        errors=(HIGH,),
    )


def test_a_clock_that_is_wrong_is_told_once() -> None:
    gathered, skewed = Gathered(), load(10.0, stamp=seconds(5))
    for before in (NO_MARKS, Marks.of(skewed)):
        gathered.add_signal(before, Marks.of(skewed), skewed)

    assert gathered.build({}).skewed == ("load",)
