"""Rules of a model, told as what an operator sees of a robot that loses a part."""

from dataclasses import replace

import pytest

from domain.conditions.condition import Condition
from domain.inputs import BackendStatus
from domain.kept import KeptEffectiveTarget
from domain.lifecycle import LifecycleState
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import Rule
from domain.simulation.node_settings import Fault
from domain.snapshot import Because, ChangeStatus
from domain.state_and_mode import DEFAULT_MODE, PartName
from service.files.model_file import read_model
from tests.support.models import ACTUATION, ARM, BASE, active, actuation_model, inactive
from tests.support.ruled_robot import (
    RuledRobot,
    degrading_model,
    guarded_model,
    nested_ruled_model,
    with_rules,
)
from tests.support.shared import PROJECT

S = LifecycleState
DEFAULT = "active.__DEFAULT__"
BEGAN, ENDED = "target.displacement_began", "target.displacement_ended"
STAYS, NOT_APPLIED = "target.displacement_stays", "rule.not_applied"


def degrading() -> RuledRobot:
    return RuledRobot(degrading_model())


# --- it acts -------------------------------------------------------------------------------------


def test_a_deviation_that_lasts_for_a_second_is_acted_on_and_a_shorter_one_is_not() -> None:
    robot = degrading().in_performance()
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(0.999)
    assert robot.target("actuation") == "active.PERFORMANCE"
    robot.advance(0.001)
    assert robot.target("actuation") == f"{DEFAULT} by degrade"


def test_a_part_that_is_back_within_a_second_leaves_everything_as_it_is() -> None:
    robot = degrading().in_performance()
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(0.9)
    robot.somebody_asks("manipulator", "activate")
    robot.advance(10)

    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert robot.happened(BEGAN) == []


def test_nothing_is_acted_on_while_the_requested_change_runs() -> None:
    """Issue #94 of system_modes: the arm is inactive in the middle of a wanted change."""
    robot = degrading()
    robot.ask_mode("actuation", "__DEFAULT__")
    robot.advance(2)
    robot.fault("manipulator", Fault.SLOW)
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(30)

    assert robot.happened(BEGAN) == []
    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_a_change_of_the_part_itself_is_waited_for_too() -> None:
    robot = degrading().in_performance()
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(0.5)
    robot.fault("manipulator", Fault.SLOW)
    robot.ask_mode("manipulator", "STRONG")
    robot.advance(1.5)
    assert robot.actual("manipulator") == "activating"
    robot.advance(20)

    assert robot.happened(BEGAN) == []


def test_after_a_change_that_failed_the_deviation_has_to_last_from_there() -> None:
    robot = degrading()
    robot.ask_mode("actuation", "__DEFAULT__")
    robot.advance(2)
    robot.fault("manipulator", Fault.REFUSE)
    change = robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(0.5)
    ended = robot.change(change)
    assert ended.status is ChangeStatus.FAILED
    robot.advance(10)

    (began,) = (event for event in robot.events if event.kind == BEGAN)
    assert ended.ended_at is not None
    assert began.at == ended.ended_at + 1_000_000_000


def test_of_two_rules_that_match_the_first_of_the_file_acts() -> None:
    second = Rule("second", active("MODERATE"), (ARM, inactive()), inactive())
    first = Rule("first", active("MODERATE"), (ARM, inactive()), active())
    robot = RuledRobot(with_rules(actuation_model(), ACTUATION, first, second))
    robot.ask_mode("actuation", "MODERATE")
    robot.advance(2)
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(5)

    assert robot.target("actuation") == f"{DEFAULT} by first"
    assert len(robot.happened(BEGAN)) == 1


def test_a_rule_is_about_the_target_in_force_when_it_acts() -> None:
    robot = degrading()
    robot.ask_mode("actuation", "MODERATE")
    robot.advance(2)
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(5)

    assert robot.target("actuation") == "active.MODERATE", "the rules are about PERFORMANCE"


def test_a_second_rule_acts_on_what_the_first_one_set() -> None:
    further = Rule("further", active(), (BASE, inactive()), inactive())
    robot = RuledRobot(degrading_model(further)).degraded()
    robot.somebody_asks("drive_base", "deactivate")
    robot.advance(2)
    assert robot.target("actuation") == "inactive by further"

    robot.somebody_asks("drive_base", "activate")
    robot.advance(2)
    assert robot.target("actuation") == f"{DEFAULT} by degrade", "the arm is still missing"
    robot.somebody_asks("manipulator", "activate")
    robot.advance(2)
    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_what_is_unknown_of_a_part_is_no_cause() -> None:
    robot = degrading().in_performance()
    robot.fault("manipulator", Fault.DIE)
    robot.advance(20)

    assert robot.happened(BEGAN) == []


def test_while_the_backend_is_down_nothing_is_acted_on_and_afterwards_it_is() -> None:
    robot = degrading().in_performance()
    robot.somebody_asks("manipulator", "deactivate")
    robot.give(BackendStatus(available=False, reason="no network"))
    robot.advance(5)
    assert robot.happened(BEGAN) == []
    robot.give(BackendStatus(available=True))
    robot.advance(1)

    assert robot.target("actuation") == f"{DEFAULT} by degrade"


# --- it returns ----------------------------------------------------------------------------------


def test_once_the_cause_has_been_gone_for_a_second_the_system_returns_by_itself() -> None:
    robot = degrading().degraded()
    robot.somebody_asks("manipulator", "activate")
    gone_at = robot.happened_at("part.actual_changed", "manipulator", "activating")
    robot.advance(5)

    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert robot.pursued("drive_base").because is Because.REQUESTED
    (ended,) = (event for event in robot.events if event.kind == ENDED)
    assert ended.at == gone_at + 1_000_000_000
    assert ended.data["target"] == "active.PERFORMANCE"
    assert robot.core.changes()[0].request.actor.label == "rule:degrade"


def test_a_cause_that_is_gone_for_less_leaves_the_system_degraded() -> None:
    robot = degrading().degraded()
    robot.somebody_asks("manipulator", "activate")
    robot.advance(0.5)
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(10)

    assert robot.happened(ENDED) == []
    assert robot.target("actuation") == f"{DEFAULT} by degrade"


def test_a_part_that_falls_silent_is_not_back() -> None:
    robot = degrading().degraded()
    robot.fault("manipulator", Fault.DIE)
    robot.advance(20)

    assert robot.target("actuation") == f"{DEFAULT} by degrade"


def test_a_newer_request_is_never_undone() -> None:
    robot = degrading().degraded()
    robot.ask_mode("actuation", "MODERATE")
    robot.advance(20)

    assert robot.target("actuation") == "active.MODERATE"
    assert robot.actual("actuation") == "active.MODERATE"
    (ended,) = robot.happened(ENDED)
    assert (ended["target"], ended["reason"]) == ("active.MODERATE", "a newer request")


def test_a_request_while_the_system_is_about_to_return_counts() -> None:
    robot = degrading().degraded()
    robot.somebody_asks("manipulator", "activate")
    robot.advance(0.5)
    robot.ask_mode("actuation", "__DEFAULT__")
    robot.advance(20)

    assert robot.actual("actuation") == DEFAULT
    assert robot.pursued("actuation").because is Because.REQUESTED


def test_the_same_request_again_is_tried_and_degraded_again() -> None:
    robot = degrading().degraded()
    robot.fault("manipulator", Fault.REFUSE)
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(5)

    assert len(robot.happened(BEGAN)) == 2
    assert robot.target("actuation") == f"{DEFAULT} by degrade"


def test_a_request_for_a_part_outranks_what_it_inherited() -> None:
    robot = degrading().degraded()
    robot.ask_mode("drive_base", "SLOW")
    robot.advance(5)

    assert robot.target("drive_base") == "active.SLOW"
    assert robot.actual("drive_base") == "active.SLOW"
    assert robot.target("actuation") == f"{DEFAULT} by degrade", "of the system nothing was asked"


def test_an_operator_who_mends_the_part_lets_the_system_return() -> None:
    robot = degrading().degraded()
    robot.ask_mode("manipulator", "STRONG")
    robot.advance(5)

    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert robot.target("actuation") == "active.PERFORMANCE"


# --- bounds --------------------------------------------------------------------------------------


def flap(robot: RuledRobot) -> None:
    """Lose the arm for some time, and get it back."""
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(2)
    robot.somebody_asks("manipulator", "activate")
    robot.advance(2)


def test_a_system_returns_three_times_in_a_minute_and_then_stays_and_says_why() -> None:
    robot = degrading().in_performance()
    for _ in range(3):
        flap(robot)
        assert robot.actual("actuation") == "active.PERFORMANCE"
    flap(robot)
    robot.advance(120)

    assert robot.target("actuation") == f"{DEFAULT} by degrade"
    why = "it has returned 3 times within 60 s: it stays until a change of it is requested"
    assert robot.why("actuation") == [("TOO_OFTEN", why)]
    assert [event["reason"] for event in robot.happened(STAYS)] == [why]
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_who_returns_seldom_returns_any_number_of_times() -> None:
    robot = degrading().in_performance()
    for _ in range(6):
        flap(robot)
        robot.advance(20)

    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert len(robot.happened(ENDED)) == 6


def test_a_rule_acts_four_times_in_a_minute_and_then_waits() -> None:
    robot = degrading().in_performance()
    robot.somebody_asks("manipulator", "deactivate")
    robot.fault("manipulator", Fault.REFUSE)
    for _ in range(4):
        robot.advance(2)
        robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    assert len(robot.happened(BEGAN)) == 4
    assert robot.target("actuation") == "active.PERFORMANCE"
    (refused,) = robot.happened(NOT_APPLIED)
    assert refused["reason"] == "it was applied 4 times within 60 s"

    first = next(event.at for event in robot.events if event.kind == BEGAN)
    robot.advance(60)
    last = [event.at for event in robot.events if event.kind == BEGAN][-1]
    assert last == first + 60_000_000_000
    assert robot.target("actuation") == f"{DEFAULT} by degrade"


# --- ESTOP ---------------------------------------------------------------------------------------


def test_under_estop_no_system_returns_nor_because_of_its_end() -> None:
    robot = degrading().degraded()
    robot.stop()
    robot.somebody_asks("manipulator", "activate")
    robot.advance(5)
    assert robot.target("actuation") == f"{DEFAULT} by degrade"
    robot.release_stop()
    robot.advance(120)

    assert robot.target("actuation") == f"{DEFAULT} by degrade"
    why = "ESTOP was active: nothing is made up for until a change of it is requested"
    assert robot.why("actuation") == [("ESTOP", why)]
    assert [event["reason"] for event in robot.happened(STAYS)] == [why]


def test_a_stop_that_is_released_in_time_still_keeps_the_system_where_it_is() -> None:
    robot = degrading().degraded()
    robot.somebody_asks("manipulator", "activate")
    robot.stop()
    robot.advance(0.1)
    robot.release_stop()
    robot.advance(20)

    assert robot.target("actuation") == f"{DEFAULT} by degrade"


def test_a_stop_that_is_over_before_the_cause_goes_keeps_nothing() -> None:
    robot = degrading().degraded()
    robot.stop()
    robot.advance(5)
    robot.release_stop()
    robot.advance(5)
    robot.somebody_asks("manipulator", "activate")
    robot.advance(5)

    assert robot.actual("actuation") == "active.PERFORMANCE"


def test_under_estop_a_rule_still_makes_a_system_slower() -> None:
    robot = degrading().in_performance()
    robot.stop()
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(2)

    assert robot.actual("drive_base") == DEFAULT


def test_a_rule_that_would_activate_under_estop_is_not_made_up_for() -> None:
    up = Rule("up", active(), (BASE, active("SLOW")), active("MODERATE"))
    robot = RuledRobot(degrading_model(up))
    robot.ask_mode("actuation", "__DEFAULT__")
    robot.advance(2)
    robot.stop()
    robot.somebody_sets("drive_base", "SLOW")
    robot.advance(2)
    robot.release_stop()
    robot.advance(20)

    assert robot.happened(BEGAN) == []
    (refused,) = robot.happened(NOT_APPLIED)
    assert refused == {
        "part": "actuation",
        "rule": "up",
        "target": "active.MODERATE",
        "reason": "ESTOP was active: nothing is made up for until a change of it is requested",
    }


# --- systems in systems --------------------------------------------------------------------------


def test_a_request_for_what_contains_a_system_ends_what_a_rule_set() -> None:
    robot = RuledRobot(nested_ruled_model())
    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(0.5)
    robot.ask_mode("robot", "PARKED")
    robot.advance(5)
    assert robot.target("actuation") == "inactive"
    assert robot.happened(BEGAN) == []


def test_the_outer_system_acts_after_the_inner_one_and_returns_with_it() -> None:
    robot = RuledRobot(nested_ruled_model())
    robot.ask_mode("robot", "RACE")
    robot.advance(2)
    assert robot.actual("robot") == "active.RACE"
    robot.fault("manipulator", None)
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(6)

    began = [(event["part"], event["rule"]) for event in robot.happened(BEGAN)]
    assert began[0] == ("actuation", "degrade")
    assert robot.asked("robot") == "active.RACE"
    robot.advance(60)
    assert robot.actual("robot") == "active.RACE", "MODERATE mends the arm"


def test_the_example_of_the_vehicle_is_careful_without_gps_and_then_cruises_again() -> None:
    text = (PROJECT / "examples" / "models" / "gem_e2.yaml").read_text(encoding="utf-8")
    robot = RuledRobot(read_model(text).model)
    robot.ask_mode("vehicle", "CRUISE")
    robot.advance(4)
    robot.somebody_asks("gps", "deactivate")
    robot.advance(6)
    assert robot.actual("vehicle") == "active.CAREFUL"
    assert robot.target("path_tracker") == "active.SLOW by careful_without_gps"

    robot.somebody_asks("gps", "activate")
    robot.advance(6)
    assert robot.actual("vehicle") == "active.CRUISE"
    assert robot.target("localization") == DEFAULT
    assert [(event["part"], event["rule"]) for event in robot.happened(BEGAN)] == [
        ("localization", "go_on_without_gps"),
        ("vehicle", "careful_without_gps"),
    ]


# --- rules that undo each other ------------------------------------------------------------------


def test_rules_that_undo_each_other_follow_the_part_and_do_not_fight() -> None:
    robot = RuledRobot(guarded_model())
    robot.ask_mode("safety", "__DEFAULT__")
    robot.advance(2)
    robot.somebody_sets("guard", "COMPROMISED")
    robot.advance(10)
    assert robot.actual("safety") == "active.COMPROMISED"
    assert robot.asked("safety") == DEFAULT

    robot.somebody_sets("guard", "__DEFAULT__")
    robot.advance(10)
    assert robot.actual("safety") == DEFAULT
    assert robot.target("safety") == DEFAULT
    assert (len(robot.happened(BEGAN)), len(robot.happened(ENDED))) == (1, 1)


@pytest.mark.parametrize("first", ["COMPROMISED", "__DEFAULT__"])
def test_what_is_requested_is_reached_and_stays(first: str) -> None:
    robot = RuledRobot(guarded_model())
    for mode in (first, "COMPROMISED", "__DEFAULT__", "COMPROMISED"):
        robot.ask_mode("safety", mode)
        robot.advance(30)
        assert robot.actual("safety") == f"active.{mode}"
        assert robot.target("safety") == f"active.{mode}"


# --- after a restart -----------------------------------------------------------------------------


def test_what_a_rule_set_survives_a_restart_and_nothing_returns_by_itself() -> None:
    robot = degrading().degraded()
    cause = robot.pursued("actuation").cause
    robot.come_back()
    robot.advance(2)
    assert robot.target("drive_base") == f"{DEFAULT} by degrade"
    assert robot.asked("actuation") == "active.PERFORMANCE"
    assert robot.pursued("actuation").cause == cause
    assert robot.why("actuation") == [("RULE", "manipulator is inactive")]

    robot.somebody_asks("manipulator", "activate")
    robot.advance(20)
    assert robot.target("actuation") == f"{DEFAULT} by degrade"
    assert [code for code, _ in robot.why("actuation")] == ["RESTART"]

    robot.ask_mode("actuation", "PERFORMANCE")
    robot.advance(2)
    assert robot.actual("actuation") == "active.PERFORMANCE"
    assert not [kept for kept in robot.kept.values() if isinstance(kept, KeptEffectiveTarget)]


def test_a_part_that_outranked_a_rule_still_does_after_a_restart() -> None:
    robot = degrading().degraded()
    robot.ask_mode("drive_base", "SLOW")
    robot.advance(2)
    robot.come_back()
    robot.advance(2)

    assert robot.target("drive_base") == "active.SLOW"
    assert robot.target("manipulator") == "inactive by degrade"


def test_after_a_restart_a_rule_deactivates_and_activates_nothing() -> None:
    up = Rule("up", active("MODERATE"), (BASE, active("FAST")), active("PERFORMANCE"))
    robot = RuledRobot(degrading_model(up)).in_performance()
    robot.come_back()
    robot.advance(2)
    robot.somebody_asks("drive_base", "deactivate")
    robot.advance(2)
    assert robot.target("actuation") == "inactive by park"
    assert robot.actual("manipulator") == "inactive"


def test_after_a_restart_a_rule_that_would_activate_waits_for_an_operator() -> None:
    up = Rule("up", active(), (BASE, active("SLOW")), active("MODERATE"))
    robot = RuledRobot(degrading_model(up))
    robot.ask_mode("actuation", "__DEFAULT__")
    robot.advance(2)
    robot.come_back()
    robot.advance(2)
    robot.somebody_sets("drive_base", "SLOW")
    robot.advance(20)

    assert robot.target("actuation") == DEFAULT
    assert [event["rule"] for event in robot.happened(NOT_APPLIED)] == ["up"]


def test_what_a_rule_set_that_the_model_no_longer_has_is_left_out_and_told() -> None:
    robot = degrading().degraded()
    robot.model = actuation_model()
    robot.come_back()

    assert robot.target("actuation") == "active.PERFORMANCE"
    (told,) = robot.happened("service.not_restored")
    assert told["what"] == f"the target {DEFAULT} of actuation that a rule set"


# --- and others ----------------------------------------------------------------------------------


def test_a_rule_waits_for_the_guards_of_what_it_sets() -> None:
    charged = ModeSettings(requires=(Condition("battery_level > 0.5"),))
    settings = {ACTUATION: {DEFAULT_MODE: charged}}
    robot = RuledRobot(replace(degrading_model(), mode_settings=settings)).in_performance()
    robot.read(battery_level=0.3)
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(1.5)
    assert robot.happened(BEGAN) == []
    assert len(robot.happened(NOT_APPLIED)) == 1

    robot.read(battery_level=0.9)
    robot.advance(1)
    assert robot.target("actuation") == f"{DEFAULT} by degrade"


def test_a_model_without_rules_has_nothing_to_act_on() -> None:
    robot = RuledRobot(actuation_model()).in_performance()
    robot.somebody_asks("manipulator", "deactivate")
    robot.advance(20)

    assert robot.target("actuation") == "active.PERFORMANCE"
    assert PartName("actuation") in robot.core.parts()
