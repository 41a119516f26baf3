"""The robot's own errors in the list of all errors."""

from dataclasses import replace

import pytest

from domain.health.health import Health
from domain.health.signals import Recovery, default_signals
from domain.inputs import Reading, Readings, SignalValue
from domain.outbox import Outbox
from domain.snapshot import ErrorKey, ErrorState, ErrorView
from domain.timebase import seconds
from tests.support.good import GOOD

S = ErrorState


class Robot:
    """The health of a robot, and its list of errors."""

    def __init__(self, recovery: Recovery = Recovery.AUTOMATIC) -> None:
        self.outbox = Outbox()
        signals = [replace(item, recovery=recovery, stale_after=0) for item in default_signals()]
        self.health = Health(signals, self.outbox, 0)
        self.read(0, **GOOD)
        self.outbox.take()

    def read(self, at_s: float, **values: SignalValue) -> None:
        self.health.pass_time(seconds(at_s))
        items = tuple(Reading(name, value) for name, value in values.items())
        self.health.take_readings(Readings(items, "test"), seconds(at_s))

    def acknowledge(self, error: str, at_s: float) -> None:
        self.health.acknowledge(ErrorKey(None, error), seconds(at_s))
        self.health.error_list.acknowledge(ErrorKey(None, error))

    def error(self, name: str) -> ErrorView:
        return self.health.error_list.view(ErrorKey(None, name))


def test_signals_that_were_never_seen_are_an_error_from_the_start() -> None:
    outbox = Outbox()
    health = Health(default_signals(), outbox, 7)
    (stale,) = health.error_list.open_ones().values()
    assert (stale.key.name, stale.state, stale.since) == ("STALE_DATA", S.ACTIVE, 7)
    assert stale.first_out


def test_all_errors_are_listed_by_their_bits() -> None:
    names = [view.key.error for view in Robot().health.error_views()]
    assert names == [
        "BATTERY_LOW",
        "ESTOP",
        "GPS_LOST",
        "SIGNAL_LOST",
        "SIGNAL_LOW",
        "TEMPERATURE_HIGH",
        "STALE_DATA",
    ]


def test_an_error_is_active_with_what_was_measured_and_then_normal() -> None:
    robot = Robot()
    robot.read(1, battery_level=0.4)
    robot.read(2, battery_level=0.3)
    low = robot.error("BATTERY_LOW")
    assert (low.state, low.value, low.threshold) == (S.ACTIVE, 0.3, 0.5)
    assert (low.since, low.count) == (seconds(1), 1)
    assert robot.outbox.take().errors == {ErrorKey(None, "BATTERY_LOW")}
    robot.read(3, battery_level=0.9)
    robot.acknowledge("BATTERY_LOW", 4)
    assert (robot.error("BATTERY_LOW").state, robot.error("BATTERY_LOW").message) == (S.NORMAL, "")


def test_an_error_that_ended_unseen_has_returned_with_what_was_measured() -> None:
    robot = Robot()
    robot.read(1, battery_level=0.4)
    robot.read(3, battery_level=0.9)
    low = robot.error("BATTERY_LOW")
    assert (low.state, low.value, low.since) == (S.RETURNED, 0.4, seconds(1))


def test_an_error_that_needs_time_is_pending_and_settles() -> None:
    robot = Robot()
    robot.read(1, gps_accuracy=300.0)
    assert (robot.error("GPS_LOST").state, robot.error("GPS_LOST").count) == (S.PENDING, 0)
    robot.read(2, gps_accuracy=100.0)
    assert robot.error("GPS_LOST").state is S.NORMAL
    robot.read(3, gps_accuracy=300.0)
    robot.health.pass_time(seconds(20))
    assert (robot.error("GPS_LOST").state, robot.error("GPS_LOST").since) == (S.ACTIVE, seconds(17))


@pytest.mark.parametrize("acknowledged_first", [True, False])
def test_an_error_that_waits_for_an_operator_says_so(*, acknowledged_first: bool) -> None:
    robot = Robot(Recovery.ACKNOWLEDGE)
    robot.read(1, temperature=60.0)
    assert robot.error("TEMPERATURE_HIGH").state is S.ACTIVE
    if acknowledged_first:
        robot.acknowledge("TEMPERATURE_HIGH", 2)
        assert robot.error("TEMPERATURE_HIGH").state is S.ACKNOWLEDGED
        robot.read(3, temperature=20.0)
    else:
        robot.read(3, temperature=20.0)
        assert robot.error("TEMPERATURE_HIGH").state is S.LATCHED
        robot.acknowledge("TEMPERATURE_HIGH", 4)
    assert robot.error("TEMPERATURE_HIGH").state is S.NORMAL


def test_a_cause_that_comes_again_makes_an_acknowledgement_void() -> None:
    robot = Robot(Recovery.ACKNOWLEDGE)
    robot.read(1, temperature=60.0)
    robot.read(2, temperature=20.0)
    robot.read(3, temperature=60.0)
    again = robot.error("TEMPERATURE_HIGH")
    assert (again.state, again.count, again.since) == (S.ACTIVE, 1, seconds(1))
