"""Errors of signals that belong to a part, or are not bad enough for ERROR."""

from dataclasses import replace

import pytest

from domain.events.event import RecordedEvent
from domain.events.health import ErrorCleared, ErrorRaised
from domain.health.health import Health
from domain.health.signals import (
    Bound,
    Comparison,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import Reading, Readings, Restored
from domain.kept import KeptError
from domain.outbox import Outbox
from domain.snapshot import ErrorKey, ErrorState, Severity, SystemState, TaskStatus
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.good import GOOD

LIDAR = PartName("lidar")
SLOW = ErrorKey(LIDAR, "SCAN_SLOW")
STALE = ErrorKey(LIDAR, "SCAN_STALE")
SCAN = SignalSettings(
    SignalSpec("scan", SignalKind.NUMBER, "Hz"),
    (Bound("SCAN_SLOW", Comparison.BELOW, 8.0),),
    part=LIDAR,
    severity=Severity.URGENT,
)


class Robot:
    """A robot that is well, with the rate of a scan."""

    def __init__(self, scan: SignalSettings) -> None:
        self.outbox = Outbox()
        usual = [replace(item, stale_after=0) for item in default_signals()]
        self.health = Health([*usual, scan], self.outbox, 0)
        self.give(0, **GOOD)

    def give(self, at_s: float, **values: bool | float | str) -> tuple[RecordedEvent, ...]:
        self.health.pass_time(seconds(at_s))
        items = tuple(Reading(name, value) for name, value in values.items())
        self.health.take_readings(Readings(items, "test"), seconds(at_s))
        return self.outbox.take().events

    @property
    def is_in_error(self) -> bool:
        view = self.health.system_state(TaskStatus.NO_TASK)
        assert (view.state is SystemState.ERROR) is bool(view.error_code)
        return view.state is SystemState.ERROR


@pytest.mark.parametrize("severity", [Severity.WARNING, Severity.URGENT])
def test_an_error_below_critical_is_on_and_the_robot_is_not_in_error(severity: Severity) -> None:
    robot = Robot(replace(SCAN, severity=severity))
    events = robot.give(1, scan=3.0)

    assert ErrorRaised("SCAN_SLOW", "scan 3 Hz is below 8 Hz", 3.0, 8.0, LIDAR) in [
        recorded.event for recorded in events
    ]
    view = robot.health.error_list.view(SLOW)
    assert (view.state, view.severity, view.value) == (ErrorState.ACTIVE, severity, 3.0)
    assert not robot.is_in_error
    assert (robot.health.errors, robot.health.reasons) == ((), ())

    events = robot.give(2, scan=10.0)
    assert ErrorCleared("SCAN_SLOW", LIDAR) in [recorded.event for recorded in events]


@pytest.mark.parametrize("severity", [Severity.CRITICAL, Severity.FATAL])
def test_a_critical_error_of_a_part_sets_the_bit_that_declared_signals_share(
    severity: Severity,
) -> None:
    robot = Robot(replace(SCAN, severity=severity))
    robot.give(1, scan=3.0)

    view = robot.health.system_state(TaskStatus.NO_TASK)
    assert (view.error_code, view.errors) == (128, ("lidar.SCAN_SLOW",))
    (reason,) = view.reasons
    assert (reason.code, reason.path) == ("SCAN_SLOW", ("lidar", "scan"))


def test_staleness_below_critical_is_an_error_of_its_own() -> None:
    robot = Robot(SCAN)
    assert not robot.is_in_error, "it is stale from the start, and that is no STALE_DATA"
    robot.give(1, scan=10.0)
    robot.health.pass_time(seconds(3.1))

    view = robot.health.error_list.view(STALE)
    assert (view.state, view.severity) == (ErrorState.ACTIVE, Severity.URGENT)
    assert view.message == "no reading of scan for 2 s"
    assert not robot.is_in_error


def test_staleness_of_a_critical_signal_of_a_part_is_stale_data_of_the_robot() -> None:
    robot = Robot(replace(SCAN, severity=Severity.CRITICAL))
    assert robot.health.errors == ("STALE_DATA",)


def test_the_errors_of_a_part_are_listed_apart_from_those_of_the_robot() -> None:
    health = Robot(SCAN).health
    assert [view.key for view in health.error_views(LIDAR)] == [SLOW, STALE]
    assert all(view.key.part is None for view in health.error_views())


def test_two_parts_may_have_errors_of_the_same_name() -> None:
    outbox = Outbox()
    other = replace(SCAN, spec=replace(SCAN.spec, name="points"), part=PartName("camera"))
    health = Health([*default_signals(), SCAN, other], outbox, 0)
    health.take_readings(Readings((Reading("points", 1.0),), "test"), 1)

    assert health.error_list.is_on(ErrorKey(PartName("camera"), "SCAN_SLOW"))
    assert not health.error_list.is_on(SLOW)


def test_an_error_of_a_part_that_waits_for_an_operator_survives_a_restart() -> None:
    waiting = replace(SCAN, recovery=Recovery.ACKNOWLEDGE, stale_after=0)
    robot = Robot(waiting)
    robot.health.take_readings(Readings((Reading("scan", 3.0),), "test"), seconds(1))
    (keeping,) = robot.outbox.take().kept
    assert keeping.name == "lidar.SCAN_SLOW"
    assert isinstance(keeping.value, KeptError)

    again = Robot(waiting)
    again.health.restore(Restored((keeping.value,)), seconds(2))
    assert again.health.error_list.view(SLOW).state is ErrorState.LATCHED
