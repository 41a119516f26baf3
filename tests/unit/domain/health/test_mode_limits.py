"""Limits by mode: what is too much depends on what the robot is doing."""

from domain.events.health import SignalLimitsChanged
from domain.health.signals import ModeLimit, SignalSettings, default_signals
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.state_and_mode import ModeName, PartName
from domain.supervision import SupervisionSettings
from domain.windows.settings import Statistic
from tests.support.core_robot import CoreRobot
from tests.support.models import actuation_model
from tests.support.watched_robot import above, below, monitor, signal

BASE, ARM = PartName("drive_base"), PartName("manipulator")
FAST, SLOW, STRONG = ModeName("FAST"), ModeName("SLOW"), ModeName("STRONG")


def by_mode(for_s: float = 0.0) -> tuple[ModeLimit, ...]:
    return (
        ModeLimit(above(60, for_s=for_s), BASE, FAST),
        ModeLimit(above(80, for_s=for_s)),
    )


class Robot(CoreRobot):
    """The robot of D4.8 with a signal, `load`."""

    def __init__(self, *signals: SignalSettings) -> None:
        settings = SupervisionSettings((*default_signals(), *signals))
        super().__init__(actuation_model(), settings)

    def be(self, mode: ModeName | None, node: PartName = BASE) -> None:
        """Let a node report what it is in; None: it cannot be reached."""
        if mode is None:
            self.give(NodeReport(node, LifecycleState.UNKNOWN, reachable=False))
        else:
            self.give(NodeReport(node, LifecycleState.ACTIVE, mode))

    def is_high(self) -> bool:
        return "HIGH" in self.core.system_state().errors

    def because(self) -> object:
        return self.core.signal("load").settings["limits_because"]

    @property
    def told(self) -> list[SignalLimitsChanged]:
        events = (recorded.event for recorded in self.events)
        return [event for event in events if isinstance(event, SignalLimitsChanged)]


def test_another_mode_has_other_limits_in_the_same_step() -> None:
    robot = Robot(signal(limits=by_mode()))
    robot.read(load=70.0)
    assert (robot.is_high(), robot.because()) == (False, "default")

    robot.be(FAST)
    assert (robot.is_high(), robot.because()) == (True, "drive_base.FAST")
    assert robot.told == [SignalLimitsChanged("load", "drive_base.FAST", above=60.0)]
    assert robot.core.signal("load").settings["threshold"] == 60.0

    robot.be(SLOW)
    assert (robot.is_high(), robot.because()) == (False, "default")


def test_how_long_it_is_bad_counts_from_the_change() -> None:
    robot = Robot(signal(limits=by_mode(for_s=2)))
    robot.read(load=90.0)
    robot.advance(1.5)
    robot.be(FAST)
    robot.advance(1.9)
    assert not robot.is_high(), "bad for 3.4 s, and for 1.9 s by these limits"
    robot.advance(0.1)
    assert robot.is_high()


def test_an_error_that_is_on_stays_if_the_value_is_beyond_the_new_limit_too() -> None:
    robot = Robot(signal(limits=by_mode(for_s=2)))
    robot.read(load=90.0)
    robot.advance(2)
    robot.be(FAST)
    assert robot.is_high()
    assert [event.because for event in robot.told] == ["drive_base.FAST"]


def test_an_unknown_mode_keeps_the_last_limits() -> None:
    robot = Robot(signal(limits=by_mode()))
    robot.be(FAST)
    robot.read(load=70.0)
    robot.be(None)
    assert (robot.is_high(), robot.because()) == (True, "drive_base.FAST")


def test_until_a_mode_is_known_the_default_is_in_force() -> None:
    robot = Robot(signal(limits=by_mode()))
    robot.read(load=90.0)
    assert (robot.is_high(), robot.because()) == (True, "default")


def test_without_a_default_no_value_is_bad_in_other_modes() -> None:
    robot = Robot(signal(limits=by_mode()[:1]))
    robot.read(load=1e6)
    assert (robot.is_high(), robot.because()) == (False, None)
    robot.be(FAST)
    assert robot.is_high()
    robot.be(SLOW)
    assert (robot.is_high(), robot.because()) == (False, None)
    assert robot.told[-1] == SignalLimitsChanged("load", None)


def test_a_node_that_is_not_active_is_in_no_mode() -> None:
    robot = Robot(signal(limits=by_mode()))
    robot.be(FAST)
    robot.give(NodeReport(BASE, LifecycleState.INACTIVE))
    assert robot.because() == "default"


def test_of_several_that_apply_the_first_is_in_force() -> None:
    limits = (ModeLimit(above(40), ARM, STRONG), *by_mode())
    robot = Robot(signal(limits=limits))
    robot.be(SLOW, ARM)
    robot.be(FAST)
    assert robot.because() == "drive_base.FAST"
    robot.be(STRONG, ARM)
    assert robot.because() == "manipulator.STRONG"
    robot.be(None, ARM)
    robot.be(SLOW)
    assert robot.because() == "manipulator.STRONG", "it may be STRONG still"


def test_a_mode_may_turn_the_comparison_round_or_have_no_limit() -> None:
    limits = (ModeLimit(below(10, "HIGH"), BASE, FAST), ModeLimit(None, BASE, SLOW))
    robot = Robot(signal(limits=(*limits, ModeLimit(above(80)))))
    robot.be(FAST)
    robot.read(load=5.0)
    assert robot.is_high()
    robot.be(SLOW)
    assert not robot.is_high()


def test_monitors_have_limits_by_mode_too() -> None:
    watched = monitor(Statistic.MEAN, window_n=2, window_s=None, limits=by_mode())
    robot = Robot(signal(), watched)
    for load in (70.0, 70.0):
        robot.read(load=load)
    robot.be(FAST)
    assert robot.is_high()
    (view,) = robot.core.monitors()
    assert (view.limits, view.limits_because) == ({"above": 60.0}, "drive_base.FAST")


def test_a_report_that_changes_no_mode_tells_nothing() -> None:
    robot = Robot(signal(limits=by_mode()))
    for _ in range(3):
        robot.be(SLOW)
        robot.advance(1)
    assert robot.told == []
