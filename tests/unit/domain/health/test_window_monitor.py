"""Monitors: what is computed from the readings of a signal, and which errors follow from it."""

from dataclasses import replace

import pytest

from domain.errors import InvalidValueError
from domain.events.health import ErrorRaised
from domain.health.signals import ModeLimit, Recovery
from domain.health.window_monitor import SHOWN_EVERY, SOURCE
from domain.inputs import Reading, Readings
from domain.snapshot import ErrorKey, ErrorState
from domain.timebase import seconds, to_seconds
from domain.windows.settings import Statistic
from tests.support.watched_robot import WatchedRobot, above, below, monitor, signal

LOAD = signal()


def test_a_monitor_is_a_signal_whose_value_is_computed() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MEAN))
    assert robot.value() is None, "unknown until there are two readings"
    robot.read(1, load=10.0)
    assert robot.value() is None
    robot.read(2, load=20.0)

    view = robot.signal()
    assert (view.value, view.source, view.received_at) == (15.0, SOURCE, seconds(2))
    assert (view.stale, view.error) == (False, None)
    assert view.settings["of"] == "load"
    assert view.settings["statistic"] == "mean"
    assert view.settings["window_s"] == 5.0


def test_readings_of_a_monitor_are_not_taken() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MEAN))
    with pytest.raises(InvalidValueError, match="watched is computed from load; post that"):
        robot.read(1, load=10.0, watched=1.0)
    assert robot.value("load") is None, "all or nothing"


def test_its_value_raises_and_clears_an_error_as_that_of_any_signal() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MAX, above(50)))
    robot.read(1, load=10.0)
    events = robot.read(2, load=60.0)
    raised = [told.event for told in events if isinstance(told.event, ErrorRaised)]
    assert raised == [ErrorRaised("HIGH", "watched 60 is above 50", 60.0, 50.0)]
    robot.read(3, load=10.0)
    robot.read(4, load=10.0)
    robot.pass_time(6.999)
    assert robot.errors() == ("HIGH",), "60 is in the window still"
    robot.pass_time(7)
    assert robot.errors() == (), "60 left the window without a reading"


def test_it_has_to_be_bad_for_as_long_as_a_signal() -> None:
    robot = WatchedRobot(
        LOAD, monitor(Statistic.MEAN, above(50, for_s=2), window_n=2, window_s=None)
    )
    robot.read(1, load=60.0)
    robot.read(2, load=60.0)
    assert robot.signal().pending_error == "HIGH"
    robot.pass_time(3.999)
    assert robot.errors() == ()
    robot.pass_time(4)
    assert robot.errors() == ("HIGH",)
    assert robot.health.reasons[0].message == "watched 60 has been above 50 for 2 s"


def test_silence_raises_an_error_at_the_instant_at_which_the_gap_is_too_long() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.GAP, above(1.5)))
    for at_s in range(1, 8):
        robot.read(at_s, load=0.0)
    assert robot.errors() == ()
    robot.pass_time(8.5)
    assert robot.errors() == (), "strictly above"
    robot.pass_time(8.500001)
    assert robot.errors() == ("HIGH",)


def test_a_rate_that_falls_is_found_without_a_reading() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.RATE, below(0.5)))
    for at_s in range(1, 7):
        robot.read(at_s, load=0.0)
    assert robot.value() == 1.0
    robot.pass_time(8.999)
    assert robot.errors() == ()
    robot.pass_time(9)
    assert robot.errors() == ("LOW",), "two readings in 5 s are left"


def test_what_changes_all_the_time_is_computed_now_and_then_to_be_shown() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.AGE, window_s=1.0))
    robot.read(2, load=0.0)
    assert robot.value() == 0.0
    deadlines = robot.pass_time(4)
    step = to_seconds(SHOWN_EVERY)
    assert deadlines == [2 + step, 2 + 2 * step, 2 + 3 * step, 2 + 4 * step]
    assert robot.value() == 2.0


def test_what_only_readings_change_wakes_nobody() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MEAN, above(5), window_n=3, window_s=None))
    robot.read(1, load=1.0)
    robot.read(2, load=2.0)
    assert robot.health.wake_at() is None


def test_a_signal_that_is_read_often_wakes_nobody_for_what_leaves_the_window() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MEAN, above(100)))
    deadlines = []
    for number in range(1_000):
        deadlines += robot.pass_time(number * 0.02)
        robot.read(number * 0.02, load=float(number % 7))
    assert deadlines == [], "each reading computes it anyway"


def test_a_signal_that_is_read_often_is_computed_now_and_then() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.RANGE, above(50)))
    for number in range(100):
        robot.read(10 + number * 0.001, load=float(number))
        assert robot.value() in (None, 0.0, 50.0) or number == 0
    robot.pass_time(10.15)
    assert robot.value() == 99.0, "all readings since 10.05 s"
    assert robot.errors() == ("HIGH",)


def test_a_reading_beyond_the_bound_is_taken_account_of_at_once() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MAX, above(50)))
    robot.read(10, load=1.0)
    robot.read(10.001, load=1.0)
    robot.read(10.002, load=60.0)
    assert robot.errors() == ("HIGH",)


def test_an_unknown_monitor_raises_nothing_and_an_error_that_is_on_stays() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MEAN, above(50)))
    robot.read(1, load=60.0)
    assert robot.errors() == (), "one reading is too few"
    robot.read(2, load=60.0)
    assert robot.errors() == ("HIGH",)
    robot.pass_time(20)
    assert robot.value() is None
    assert robot.errors() == ("HIGH",)
    (reason,) = robot.health.reasons
    assert reason.message == "watched 60 is above 50 as last known; too few readings of it now"
    robot.read(21, load=10.0)
    robot.read(22, load=10.0)
    assert robot.errors() == ()


def test_nothing_counts_while_the_value_is_unknown() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MEAN, above(50, for_s=10)))
    robot.read(1, load=60.0)
    robot.read(2, load=60.0)
    assert robot.signal().pending_since == seconds(2)
    robot.pass_time(8)
    assert robot.signal().pending_since is None
    robot.pass_time(30)
    assert robot.errors() == ()


def test_a_message_with_several_readings_is_judged_once() -> None:
    robot = WatchedRobot(LOAD, signal("other"), monitor(Statistic.MAX, above(50), min_n=1))
    robot.read(1, load=60.0, other=1.0)
    assert robot.value() == 60.0


def test_a_chain_takes_one_value_per_reading_of_the_root() -> None:
    mean = monitor(Statistic.MEAN, name="mean", window_n=2, window_s=None)
    peak = monitor(Statistic.MAX, name="peak", of="mean", window_s=100.0, min_n=1)
    count = monitor(Statistic.COUNT, name="values", of="mean", window_s=1.0)
    robot = WatchedRobot(LOAD, peak, count, mean)
    for at_s, load in enumerate((10.0, 30.0, 20.0), start=2):
        robot.read(at_s, load=load)
    assert (robot.value("mean"), robot.value("peak")) == (25.0, 25.0)
    robot.read(5, load=80.0)
    assert (robot.value("mean"), robot.value("peak")) == (50.0, 50.0)
    robot.pass_time(5.9)
    assert robot.value("values") == 1.0, "what time does to the mean is no value of it"


def test_a_stop_and_a_member_are_numbers_of_their_own() -> None:
    pressed = monitor(Statistic.MEAN, name="pressed", of="estop", window_n=4, window_s=None)
    stuck = monitor(Statistic.STUCK_FOR, name="stuck", of="signal_strength")
    robot = WatchedRobot(pressed, stuck)
    robot.read(1, estop=True, signal_strength="CONNECTED")
    robot.read(2, estop=False, signal_strength="CONNECTED")
    assert robot.value("pressed") == pytest.approx(1 / 3)
    assert robot.value("stuck") == 2.0


def test_its_error_can_wait_for_an_operator() -> None:
    watched = replace(monitor(Statistic.MAX, above(50), min_n=1), recovery=Recovery.ACKNOWLEDGE)
    robot = WatchedRobot(LOAD, watched)
    robot.read(1, load=60.0)
    robot.pass_time(10)
    robot.read(10, load=1.0)
    view = robot.health.error_list.view(ErrorKey(None, "HIGH"))
    assert view.state is ErrorState.LATCHED


def test_a_monitor_shows_its_window_and_its_limits() -> None:
    robot = WatchedRobot(LOAD, monitor(Statistic.MEAN, above(50)))
    robot.read(2, load=1.0)
    view = robot.monitor()
    assert (view.of, view.statistic, view.window, view.size) == ("load", "mean", seconds(5), None)
    assert (view.filled, view.value) == (0.4, None)
    assert (view.limits, view.limits_because) == ({"above": 50.0}, None)


@pytest.mark.parametrize("looks", [True, False])
def test_what_changed_is_told_whether_or_not_anybody_looked_before(looks: bool) -> None:
    low, high = ModeLimit(above(80, "LOAD_HIGH")), ModeLimit(above(90, "LOAD_HIGH"))
    robot = WatchedRobot(signal(limits=(low, high)), monitor(Statistic.MEAN, above(50)))

    def told() -> set[str]:
        changed = set(robot.outbox.take().signals)
        if looks:
            robot.health.signals()
        return changed

    for at_s in (1, 2):
        robot.read(at_s, load=10.0)
        told()
    robot.health.set_limit("load", high, robot.now)
    assert told() == {"load"}, "its limit"
    robot.pass_time(2.2)
    told()
    robot.pass_time(6.2)
    assert told() == {"watched"}, "it became unknown"
    robot.health.take_readings(Readings((Reading("load", 10.0),), "test"), robot.now)
    told()
    robot.health.take_readings(Readings((Reading("load", 95.0),), "test"), robot.now)
    assert told() == {"load", "watched"}, "both turned bad"
