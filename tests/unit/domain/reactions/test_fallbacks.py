"""Invariants and fallbacks, told as what an operator sees of a robot that gets too hot."""

import pytest

from domain.actor import Actor
from domain.inputs import BackendStatus
from domain.kept import KeptEffectiveTarget
from domain.parts.system_model import Rule
from domain.simulation.node_settings import Fault
from domain.snapshot import Because, ChangeStatus
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from tests.support.falling_robot import (
    CHARGED,
    COOL,
    FULL,
    FallingRobot,
    falling_model,
    guarded,
    with_settings,
)
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    MODERATE,
    active,
    actuation_model,
    inactive,
    nested_model,
)
from tests.support.ruled_robot import with_rules

DEFAULT = "__DEFAULT__"
BEGAN, ENDED = "target.displacement_began", "target.displacement_ended"
STAYS = "target.displacement_stays"
ROBOT = PartName("robot")


def without_fallback(grace_s: float = 0.0) -> FallingRobot:
    performance = guarded(COOL, grace_s=grace_s)
    return FallingRobot(with_settings(actuation_model(), ACTUATION, PERFORMANCE=performance))


# --- it falls back -------------------------------------------------------------------------------


def test_a_robot_that_gets_too_hot_for_its_mode_falls_back_and_does_not_forget_it() -> None:
    robot = FallingRobot().performing()
    robot.reads(temperature=52.0)

    assert robot.mode() == "MODERATE invariant"
    assert robot.actual("actuation") == "active.MODERATE"
    assert robot.asked("actuation") == "active.PERFORMANCE"
    assert robot.mode("drive_base") == "SLOW invariant", "inherited"
    assert robot.core.part(ACTUATION).converged
    assert robot.broken() == ""


def test_who_set_the_target_and_why_is_shown_with_the_event_that_tells_it() -> None:
    robot = FallingRobot().fallen()

    pursued = robot.pursued("actuation")
    (began,) = (event for event in robot.events if event.kind == BEGAN)
    assert (pursued.because, pursued.rule, pursued.cause) == (Because.INVARIANT, None, began.id)
    assert began.actor == Actor("invariant:actuation")
    assert began.data == {
        "part": "actuation",
        "target": "active.MODERATE",
        "was": "active.PERFORMANCE",
        "because": "invariant",
        "rule": None,
        "reason": "temperature is 52 °C, needs < 50 °C",
    }
    (blocker,) = pursued.blockers
    assert (blocker.code, blocker.condition) == ("INVARIANT", COOL)
    assert [cause.message for cause in blocker.causes] == ["temperature is 52 °C, needs < 50 °C"]
    assert robot.core.why(ACTUATION)[0] == blocker
    caused = next(event for event in robot.events if event.id == began.cause)
    assert caused.kind == "signal.read", "the reading that broke it"


def test_a_change_in_the_name_of_the_invariant_leads_there() -> None:
    robot = FallingRobot().fallen()

    change = robot.core.changes()[0]
    assert (change.part, change.request.actor.label) == (ACTUATION, "invariant:actuation")
    assert change.status is ChangeStatus.SUCCEEDED


def test_within_its_grace_a_broken_invariant_changes_nothing() -> None:
    robot = FallingRobot(falling_model(grace_s=2)).performing()
    robot.reads(1.999, temperature=52.0)
    assert robot.mode() == "PERFORMANCE"
    robot.advance(0.001)
    assert robot.mode() == "MODERATE invariant"


def test_an_invariant_that_recovers_within_its_grace_changes_nothing() -> None:
    robot = FallingRobot(falling_model(grace_s=2)).performing()
    robot.reads(1.9, temperature=52.0)
    robot.reads(1.9, temperature=45.0)
    robot.reads(1.9, temperature=52.0)

    assert robot.happened(BEGAN) == []


def test_a_fallback_needs_nothing_of_what_its_mode_requires() -> None:
    robot = FallingRobot().performing().reads(battery_level=0.3)
    assert robot.mode() == "PERFORMANCE", "what is required is so for entering only"
    robot.reads(temperature=52.0)

    assert robot.actual("actuation") == "active.MODERATE"


def test_a_fallback_whose_own_invariants_break_falls_back_further() -> None:
    robot = FallingRobot().fallen()
    robot.reads(battery_level=0.1)

    assert robot.mode() == f"{DEFAULT} invariant"
    assert robot.actual("actuation") == f"active.{DEFAULT}"
    assert [event["was"] for event in robot.happened(BEGAN)] == [
        "active.PERFORMANCE",
        "active.MODERATE",
    ]


def test_a_fallback_that_is_broken_already_is_left_out() -> None:
    robot = FallingRobot().performing().reads(battery_level=0.1)
    robot.reads(temperature=52.0)

    assert robot.actual("actuation") == f"active.{DEFAULT}"
    assert len(robot.happened(BEGAN)) == 1


def test_a_fallback_that_breaks_on_the_way_there_is_left_at_once() -> None:
    robot = FallingRobot().performing()
    robot.fault("manipulator", Fault.SLOW)
    robot.reads(0.1, temperature=52.0)
    robot.reads(0.0, battery_level=0.1)

    assert robot.mode() == f"{DEFAULT} invariant"
    first = robot.core.changes()[1]
    assert first.status is ChangeStatus.SUPERSEDED


def test_an_invariant_that_breaks_on_the_way_fails_the_change_and_then_the_fallback_follows() -> (
    None
):
    robot = FallingRobot()
    robot.fault("manipulator", Fault.SLOW)
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.reads(0.1)
    robot.reads(20, temperature=52.0)

    assert robot.change(change).status is ChangeStatus.FAILED
    assert robot.mode() == "MODERATE invariant"
    assert robot.actual("actuation") == "active.MODERATE"


def test_an_unknown_invariant_is_broken_too() -> None:
    performance = guarded(COOL, fallback=MODERATE)
    model = with_settings(actuation_model(), ACTUATION, PERFORMANCE=performance)
    robot = FallingRobot(model, SupervisionSettings())
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    assert robot.mode() == "PERFORMANCE"
    robot.advance(0.1)

    assert robot.mode() == "MODERATE invariant", "a reading is stale after 2 s"


def test_a_node_falls_back_by_itself_and_its_system_shows_it() -> None:
    model = with_settings(actuation_model(), BASE, FAST=guarded(COOL, fallback="SLOW"))
    robot = FallingRobot(model).performing().reads(temperature=52.0)

    assert robot.mode("drive_base") == "SLOW invariant"
    assert robot.mode("actuation") == "PERFORMANCE"
    assert not robot.core.part(ACTUATION).converged
    robot.reads(2, temperature=40.0)
    assert robot.mode("drive_base") == "FAST"
    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_a_system_takes_along_the_parts_that_would_fall_back_too() -> None:
    model = with_settings(falling_model(), BASE, FAST=guarded(COOL, fallback=DEFAULT))
    robot = FallingRobot(model).performing().reads(temperature=52.0)

    assert robot.mode("drive_base") == "SLOW invariant"
    assert len(robot.happened(BEGAN)) == 1
    robot.reads(3, temperature=40.0)
    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_a_system_inside_another_falls_back_and_the_outer_request_stands() -> None:
    performance = guarded(COOL, fallback=MODERATE)
    robot = FallingRobot(with_settings(nested_model(), ACTUATION, PERFORMANCE=performance))
    robot.ask_mode("robot", "RACE")
    robot.advance(2)
    robot.reads(temperature=52.0)

    assert (robot.mode("robot"), robot.mode("actuation")) == ("RACE", "MODERATE invariant")
    robot.reads(3, temperature=40.0)
    assert robot.actual("robot") == "active.RACE"


# --- without a fallback --------------------------------------------------------------------------


def test_without_a_fallback_an_error_stands_until_the_invariant_holds_again() -> None:
    robot = without_fallback().performing()
    robot.reads(temperature=52.0)

    assert (
        robot.broken() == "actuation cannot stay PERFORMANCE: temperature is 52 °C, needs < 50 °C"
    )
    assert robot.mode() == "PERFORMANCE"
    robot.reads(temperature=40.0)
    assert robot.broken() == ""
    kinds = ["error.raised", "error.cleared"]
    told = [e.kind for e in robot.events if e.data.get("error") == "INVARIANT_BROKEN"]
    assert told == kinds


def test_the_error_ends_with_the_mode() -> None:
    robot = without_fallback().performing()
    robot.reads(temperature=52.0)
    robot.ask_mode("actuation", "MODERATE")
    robot.advance(0)

    assert robot.broken() == ""


def test_the_error_too_is_raised_only_after_the_grace() -> None:
    robot = without_fallback(grace_s=2).performing()
    robot.reads(1.999, temperature=52.0)
    assert robot.broken() == ""
    robot.advance(0.001)
    assert robot.broken() != ""


def test_the_last_fallback_stays_in_force_and_its_error_says_why_it_should_not() -> None:
    model = with_settings(
        actuation_model(),
        ACTUATION,
        PERFORMANCE=guarded(COOL, fallback=MODERATE),
        MODERATE=guarded(CHARGED),
    )
    robot = FallingRobot(model).performing().reads(battery_level=0.1)
    robot.reads(temperature=52.0)

    assert robot.actual("actuation") == "active.MODERATE"
    assert "cannot stay MODERATE" in robot.broken()


# --- it returns ----------------------------------------------------------------------------------


def test_it_returns_when_all_guards_have_held_for_a_second() -> None:
    robot = FallingRobot().fallen()
    robot.reads(0.999, temperature=40.0)
    assert robot.mode() == "MODERATE invariant"
    robot.advance(0.001)
    assert robot.mode() == "PERFORMANCE"
    robot.advance(2)
    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert robot.happened(ENDED)[0]["reason"] == "its guards hold again"


def test_a_longer_grace_is_waited_for_before_it_returns() -> None:
    robot = FallingRobot(falling_model(grace_s=3)).performing()
    robot.reads(4, temperature=52.0)
    robot.reads(2.999, temperature=40.0)
    assert robot.mode() == "MODERATE invariant"
    robot.advance(0.001)
    assert robot.mode() == "PERFORMANCE"


def test_what_the_mode_requires_must_hold_too_before_it_returns() -> None:
    robot = FallingRobot().fallen().reads(battery_level=0.35)
    robot.reads(10, temperature=40.0)
    assert robot.mode() == "MODERATE invariant"
    assert robot.why("actuation") == [("CONDITION", "battery_level is 0.35, needs >= 0.4")]
    robot.reads(1, battery_level=0.8)
    assert robot.mode() == "PERFORMANCE"


def test_while_it_waits_it_says_what_for() -> None:
    robot = FallingRobot().fallen().reads(temperature=40.0)

    assert robot.why("actuation") == [
        ("INVARIANT", "actuation returns when its guards have held for 1 s")
    ]


def test_from_the_last_fallback_it_returns_to_what_was_requested() -> None:
    robot = FallingRobot().fallen().reads(battery_level=0.1)
    robot.reads(2, battery_level=0.8)
    assert robot.mode() == f"{DEFAULT} invariant", "it is still too hot"
    robot.reads(2, temperature=40.0)

    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_it_returns_three_times_within_a_minute_and_then_stays_and_says_why() -> None:
    robot = FallingRobot().performing()
    for _ in range(4):
        robot.reads(temperature=52.0)
        robot.reads(3, temperature=40.0)
    robot.advance(100)

    assert len(robot.happened(BEGAN)) == 4
    assert len(robot.happened(ENDED)) == 3
    assert robot.mode() == "MODERATE invariant"
    ((code, _),) = robot.why("actuation")
    assert code == "TOO_OFTEN"
    robot.performing()


def test_a_newer_request_ends_what_a_fallback_displaced() -> None:
    robot = FallingRobot().fallen()
    robot.ask_mode("actuation", DEFAULT)
    robot.advance(2)
    robot.reads(10, temperature=40.0)

    assert robot.mode() == DEFAULT
    assert [event["reason"] for event in robot.happened(ENDED)] == ["a newer request"]
    assert not [kept for kept in robot.kept.values() if isinstance(kept, KeptEffectiveTarget)]


def test_a_part_of_which_something_was_requested_later_neither_falls_nor_returns() -> None:
    robot = FallingRobot().fallen()
    robot.ask_mode("drive_base", DEFAULT)
    robot.advance(1)
    robot.reads(3, temperature=40.0)

    assert robot.mode("drive_base") == DEFAULT
    assert robot.mode("manipulator") == "STRONG"
    assert robot.mode() == "PERFORMANCE"


# --- ESTOP, restarts, the backend ----------------------------------------------------------------


def test_nothing_returns_under_estop_or_because_of_its_end() -> None:
    robot = FallingRobot().fallen()
    robot.stop()
    robot.reads(5, temperature=40.0)
    assert robot.mode() == "MODERATE invariant"
    robot.release_stop()
    robot.advance(60)

    assert robot.mode() == "MODERATE invariant"
    assert [code for code, _ in robot.why("actuation")] == ["ESTOP"]
    assert len(robot.happened(STAYS)) == 1


@pytest.mark.parametrize("invariant", ["not error.ESTOP", "robot.state != ERROR"])
def test_what_breaks_with_estop_and_holds_with_its_end_does_not_return(invariant: str) -> None:
    performance = guarded(invariant, fallback=MODERATE)
    robot = FallingRobot(with_settings(actuation_model(), ACTUATION, PERFORMANCE=performance))
    robot.performing()
    robot.stop()
    robot.advance(3)
    assert robot.actual("actuation") == "active.MODERATE", "nothing is activated for that"
    robot.release_stop()
    robot.advance(60)

    assert robot.mode() == "MODERATE invariant"


def test_what_recovers_after_the_end_of_estop_returns() -> None:
    robot = FallingRobot().fallen()
    robot.stop()
    robot.advance(1)
    robot.release_stop()
    robot.advance(1)
    robot.reads(2, temperature=40.0)

    assert robot.mode() == "PERFORMANCE"


def test_under_estop_a_fallback_is_in_force_and_activates_nothing() -> None:
    fallback = guarded(COOL, fallback=MODERATE)
    robot = FallingRobot(with_settings(actuation_model(), ACTUATION, **{DEFAULT: fallback}))
    robot.ask_mode("actuation", DEFAULT)
    robot.advance(2)
    robot.stop()
    robot.reads(5, temperature=52.0)

    assert robot.mode() == "MODERATE invariant"
    assert robot.actual("manipulator") == "inactive"
    robot.release_stop()
    robot.advance(30)
    assert robot.actual("manipulator") == "inactive", "what ESTOP prevented is not made up for"


def test_a_fallback_is_kept_over_a_restart_and_nothing_returns_before_somebody_asks() -> None:
    robot = FallingRobot().fallen()
    before = robot.pursued("actuation")
    robot.come_back()
    assert robot.mode() == "MODERATE invariant"
    assert robot.pursued("actuation").cause == before.cause
    robot.read(battery_level=1.0, temperature=40.0)
    robot.advance(10)

    assert robot.mode() == "MODERATE invariant"
    assert [code for code, _ in robot.why("actuation")] == ["RESTART"]
    robot.performing()


def test_what_was_not_heard_of_yet_after_a_restart_breaks_nothing() -> None:
    robot = FallingRobot().performing()
    robot.come_back()
    robot.advance(1)
    assert robot.mode() == "PERFORMANCE"
    robot.read(temperature=40.0, battery_level=1.0)
    robot.advance(10)

    assert robot.mode() == "PERFORMANCE"


def test_what_stays_unheard_of_after_a_restart_breaks_the_invariant() -> None:
    robot = FallingRobot().performing()
    robot.come_back()
    robot.advance(1.999)
    assert robot.mode() == "PERFORMANCE"
    robot.advance(0.001)

    assert robot.mode() == f"{DEFAULT} invariant", "the battery is not known either"


def test_after_a_restart_a_fallback_activates_nothing_before_somebody_asks() -> None:
    fallback = guarded(COOL, fallback=MODERATE)
    robot = FallingRobot(with_settings(actuation_model(), ACTUATION, **{DEFAULT: fallback}))
    robot.ask_mode("actuation", DEFAULT)
    robot.advance(2)
    robot.come_back()
    robot.reads(20, temperature=52.0)

    assert robot.mode() == "MODERATE invariant"
    assert robot.actual("manipulator") == "inactive"


def test_a_fallback_that_the_model_no_longer_has_is_left_out_and_told() -> None:
    robot = FallingRobot().fallen()
    robot.model = actuation_model()
    robot.restart()

    assert robot.mode() == "PERFORMANCE"
    assert [told["reason"] for told in robot.happened("service.not_restored")] == [
        "no mode of the model falls back to it"
    ]


def test_while_the_backend_is_down_only_the_error_tells_and_the_fallback_follows() -> None:
    robot = FallingRobot().performing()
    robot.give(BackendStatus(available=False, reason="the simulation is paused"))
    robot.reads(temperature=52.0)
    assert (robot.mode(), bool(robot.broken())) == ("PERFORMANCE", True)
    robot.give(BackendStatus(available=True))
    robot.advance(1)

    assert (robot.mode(), robot.broken()) == ("MODERATE invariant", "")


# --- with rules ----------------------------------------------------------------------------------


def test_a_fallback_prevails_over_a_rule_and_what_the_rule_set_is_returned_to() -> None:
    degrade = Rule("degrade", active("PERFORMANCE"), (ARM, inactive()), active(MODERATE))
    model = with_rules(falling_model(), ACTUATION, degrade)
    robot = FallingRobot(model).performing()
    robot.somebody_asks("manipulator", "deactivate")
    robot.fault("manipulator", Fault.REFUSE)
    robot.advance(3)
    assert robot.mode() == "MODERATE rule"
    robot.reads(1, battery_level=0.1)
    assert robot.mode() == f"{DEFAULT} invariant"
    robot.reads(3, battery_level=0.9)

    assert robot.mode() == "MODERATE rule"


def test_a_rule_does_not_act_on_a_system_that_fell_back() -> None:
    park = Rule("park", active(MODERATE), (ARM, inactive()), inactive())
    robot = FallingRobot(with_rules(falling_model(), ACTUATION, park)).fallen()
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(5)

    assert robot.mode() == "MODERATE invariant"


def test_a_rule_of_an_outer_system_reaches_what_fell_back_once_that_is_where_it_may_be() -> None:
    lidar = PartName("lidar")
    calm = Rule("calm", active("RACE"), (lidar, inactive()), inactive())
    model = with_settings(nested_model(), ACTUATION, PERFORMANCE=guarded(COOL, fallback=MODERATE))
    robot = FallingRobot(with_rules(model, ROBOT, calm))
    robot.ask_mode("robot", "RACE")
    robot.advance(2)
    robot.reads(temperature=52.0)
    robot.somebody_asks("lidar", "deactivate")
    robot.advance(1.5)
    assert robot.mode("robot") == "inactive rule"
    assert robot.mode("actuation") == "MODERATE invariant"
    assert robot.actual("actuation") == "active.MODERATE"
    robot.advance(1)

    assert robot.mode("actuation") == "inactive rule", "nothing guards that"
    assert robot.actual("actuation") == "inactive"


def test_a_robot_without_invariants_is_not_looked_at() -> None:
    robot = FallingRobot(
        with_settings(actuation_model(), ACTUATION, PERFORMANCE=guarded(requires=(FULL,)))
    )
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.reads(5, battery_level=0.1)

    assert robot.mode() == "PERFORMANCE"
