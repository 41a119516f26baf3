"""When what is displaced returns, for rules and for fallbacks alike."""

import pytest

from tests.support.falling_robot import FallingRobot, guarded, with_settings
from tests.support.models import ACTUATION, BASE, MODERATE, actuation_model
from tests.support.ruled_robot import DEGRADE, RuledRobot, degrading_model


def test_what_was_requested_later_stays_where_it_is() -> None:
    robot = FallingRobot().fallen()
    robot.ask_transition("manipulator", "deactivate")
    robot.reads(5, temperature=40.0)

    assert robot.mode() == "PERFORMANCE"
    assert robot.actual("manipulator") == "inactive", "that was requested later"


def test_each_part_has_a_bound_of_its_own() -> None:
    base = guarded("gps_accuracy < 150", fallback="SLOW")
    actuation = guarded("temperature < 50", fallback=MODERATE)
    model = with_settings(with_settings(actuation_model(), ACTUATION, PERFORMANCE=actuation), BASE,
                          FAST=base)  # fmt: skip
    robot = FallingRobot(model).performing()
    for _ in range(4):
        robot.reads(gps_accuracy=180.0)
        robot.reads(3, gps_accuracy=100.0)
    assert robot.mode("drive_base") == "SLOW invariant"
    robot.reads(temperature=52.0)
    robot.reads(3, temperature=40.0)

    assert robot.mode() == "PERFORMANCE"
    assert robot.mode("drive_base") == "SLOW invariant"


def test_the_bound_is_free_again_after_a_minute() -> None:
    robot = FallingRobot().performing()
    for _ in range(3):
        robot.reads(temperature=52.0)
        robot.reads(3, temperature=40.0)
    robot.advance(60)
    robot.reads(temperature=52.0)
    robot.reads(3, temperature=40.0)

    assert robot.mode() == "PERFORMANCE"


@pytest.mark.parametrize("later_s", [0.0, 5.0])
def test_a_rule_does_not_return_what_estop_kept_displaced(later_s: float) -> None:
    robot = RuledRobot(degrading_model()).degraded()
    robot.stop()
    robot.somebody_asks("manipulator", "activate")
    robot.advance(3)
    robot.release_stop()
    robot.advance(later_s)

    assert robot.target("actuation") == f"active.__DEFAULT__ by {DEGRADE}"
