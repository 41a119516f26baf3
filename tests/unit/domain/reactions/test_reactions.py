"""Reactions, told as what an operator sees of a carrier that degrades, rests or stops."""

import pytest

from domain.actor import Actor
from domain.errors import ReservedHoldError, UnknownReactionError
from domain.inputs import BackendStatus, HoldRequest, ReleaseRequest
from domain.reaction_terms import Arm
from domain.snapshot import Because
from domain.state_and_mode import PartName
from service.checkpoint import checkpoint_of, core_of_checkpoint
from tests.support.reacting_robot import HALT, LIMP, REST, ReactingRobot

CARRIER = PartName("carrier")


# --- one reaction --------------------------------------------------------------------------------


def test_a_carrier_slows_down_while_something_is_so_and_does_not_forget_what_was_asked() -> None:
    robot = ReactingRobot(LIMP).see(a=True)

    assert robot.target() == "active.SLOW by reaction LIMP"
    assert robot.target("drive") == "active.SLOW by reaction LIMP", "inherited"
    assert robot.actual("carrier") == "active.SLOW"
    robot.see(a=False)
    assert robot.target() == "active.FAST"
    assert robot.actual("carrier") == "active.FAST"
    assert robot.told("LIMP") == ["acting", "ended"]


def test_the_target_in_force_names_the_reaction_its_event_and_what_calls_for_it() -> None:
    robot = ReactingRobot(LIMP).see(a=True)

    pursued = robot.core.part(CARRIER).effective_target
    assert pursued is not None
    (began,) = [event for event in robot.events if event.kind == "target.displacement_began"]
    assert (pursued.because, pursued.reaction, pursued.rule) == (Because.REACTION, "LIMP", None)
    assert pursued.cause == began.id
    assert began.actor == Actor("reaction:LIMP")
    (blocker,) = pursued.blockers
    assert (blocker.code, blocker.condition) == ("REACTION", "a")
    assert [cause.message for cause in blocker.causes] == ["a is true, needs false"]
    acting = next(event for event in robot.events if event.id == began.cause)
    assert acting.kind == "reaction.acting"
    read = next(event for event in robot.events if event.id == acting.cause)
    assert read.kind == "signal.read"


def test_a_condition_has_to_be_true_for_as_long_as_the_file_says() -> None:
    robot = ReactingRobot('LIMP: {when: "a", for_s: 2, action: mode, target: active.SLOW}')
    robot.see(1.999, a=True)
    assert robot.state("LIMP") == "pending"
    assert robot.target() == "active.FAST"
    robot.advance(0.001)
    assert robot.state("LIMP") == "acting"


def test_an_unknown_condition_begins_nothing_and_ends_nothing() -> None:
    limp = 'LIMP: {when: "battery_level < 0.6", action: mode, target: active.SLOW}'
    robot = ReactingRobot(limp)
    robot.read(battery_level=0.55)
    robot.advance(5)
    assert robot.core.signal("battery_level").stale
    assert robot.state("LIMP") == "acting"
    robot.read(battery_level=0.9)
    robot.advance(5)
    assert robot.core.signal("battery_level").stale
    assert robot.state("LIMP") == "idle"


# --- several -------------------------------------------------------------------------------------


def test_what_calls_for_more_takes_over_in_the_same_step_with_its_own_cause() -> None:
    robot = ReactingRobot(LIMP, REST).see(a=True)
    robot.see(0, b=True)

    assert robot.target() == "inactive by reaction REST"
    pursued = robot.core.part(CARRIER).effective_target
    assert pursued is not None
    assert [cause.message for cause in pursued.blockers[0].causes] == ["b is true, needs false"]
    assert (robot.state("LIMP"), robot.state("REST")) == ("overruled", "acting")
    assert robot.why("LIMP")[0] == "reaction REST of carrier is stronger"


def test_when_that_is_over_what_still_calls_takes_over_again() -> None:
    robot = ReactingRobot(LIMP, REST).see(a=True).see(b=True).see(b=False)

    assert robot.target() == "active.SLOW by reaction LIMP"
    assert robot.actual("carrier") == "active.SLOW"
    assert robot.told("LIMP") == ["acting", "overruled", "acting"]


def test_a_target_that_becomes_impossible_gives_way_in_the_same_step() -> None:
    crawl = 'CRAWL: {when: "a", action: mode, target: active.CRAWL}'
    robot = ReactingRobot(LIMP, crawl, settings='{SLOW: {invariants: "not b"}}').see(a=True)
    assert robot.target() == "active.SLOW by reaction LIMP"
    robot.see(0, b=True)

    assert robot.target() == "active.CRAWL by reaction CRAWL"
    assert robot.why("LIMP")[0].startswith("carrier cannot stay SLOW")
    robot.see(a=False, b=False)
    assert robot.target() == "active.FAST"


def test_of_two_equal_ones_the_first_in_the_file_acts() -> None:
    crawl = 'CRAWL: {when: "a", action: mode, target: active.CRAWL}'

    assert ReactingRobot(LIMP, crawl).see(a=True).target() == "active.SLOW by reaction LIMP"
    assert ReactingRobot(crawl, LIMP).see(a=True).target() == "active.CRAWL by reaction CRAWL"


def test_a_stronger_reaction_of_a_system_overrules_one_of_its_node() -> None:
    creep = 'CREEP: {when: "a", action: mode, target: active.CRAWL}'
    robot = ReactingRobot(REST, of_drive=creep).see(a=True)
    assert robot.target("drive") == "active.CRAWL by reaction CREEP"
    robot.see(b=True)
    assert robot.target("drive") == "inactive by reaction REST"
    assert robot.state("CREEP", "drive") == "overruled"
    robot.see(b=False)
    assert robot.target("drive") == "active.CRAWL by reaction CREEP"
    assert robot.actual("drive") == "active.CRAWL"


def test_a_stronger_reaction_of_a_node_prevails_over_one_of_its_system() -> None:
    stop = 'PARK: {when: "b", action: state, target: inactive}'
    robot = ReactingRobot(LIMP, of_drive=stop).see(b=True).see(a=True)

    assert robot.target() == "active.SLOW by reaction LIMP"
    assert robot.target("drive") == "inactive by reaction PARK"
    robot.see(b=False)
    assert robot.target("drive") == "active.SLOW by reaction LIMP"
    assert robot.actual("drive") == "active.SLOW"


# --- requests ------------------------------------------------------------------------------------


def test_a_request_that_leads_elsewhere_is_refused_with_what_calls_for_the_reaction() -> None:
    robot = ReactingRobot(LIMP).see(a=True)

    blocker = robot.refusal_of("carrier", "FAST")
    assert (blocker.code, blocker.path, blocker.refuses) == ("REACTION", ("carrier",), True)
    assert [cause.message for cause in blocker.causes] == ["a is true, needs false"]
    assert robot.refusal_of("drive", "FAST").path == ("drive", "carrier")
    (fast,) = [mode for mode in robot.core.modes(CARRIER) if mode.mode == "FAST"]
    assert not fast.can_enter
    assert fast.blockers == (blocker,)


def test_a_request_for_what_the_reaction_wants_is_accepted() -> None:
    robot = ReactingRobot(LIMP).see(a=True)
    robot.ask_mode("carrier", "SLOW")
    robot.advance(1)
    robot.see(a=False)

    assert robot.target() == "active.SLOW"
    assert next(change.status for change in robot.core.changes()) == "succeeded"


@pytest.mark.parametrize(
    ("transition", "state"),
    [("deactivate", "inactive"), ("cleanup", "unconfigured"), ("shutdown", "finalized")],
)
def test_a_part_may_always_be_brought_to_rest_and_stays_there(transition: str, state: str) -> None:
    robot = ReactingRobot(LIMP).see(a=True)
    robot.rest("carrier", transition)

    assert robot.actual("carrier") == state
    assert robot.target() == state
    assert robot.why("LIMP")[0] == f"carrier was brought to {state} on request"
    robot.see(a=False).see(a=True)
    assert robot.actual("carrier") == state, "whichever came first"


def test_who_brought_a_part_to_rest_cannot_lead_it_past_the_reaction_either() -> None:
    robot = ReactingRobot(LIMP).see(a=True)
    robot.rest("carrier")

    assert robot.refusal_of("carrier", "FAST").code == "REACTION"
    robot.ask_mode("carrier", "SLOW")
    robot.advance(1)
    assert robot.target() == "active.SLOW by reaction LIMP"


def test_a_node_that_was_brought_to_rest_is_left_out_when_its_system_reacts() -> None:
    robot = ReactingRobot(LIMP)
    robot.rest("drive")
    robot.see(a=True)

    assert robot.target() == "active.SLOW by reaction LIMP"
    assert (robot.target("drive"), robot.actual("drive")) == ("inactive", "inactive")


def test_a_deeper_rest_prevails_over_a_state_of_a_reaction_and_the_other_way() -> None:
    robot = ReactingRobot('OFF: {when: "b", action: state, target: unconfigured}')
    robot.rest("carrier")
    robot.see(b=True)
    assert robot.actual("carrier") == "unconfigured"
    robot.see(b=False)
    robot.rest("carrier", "shutdown")
    robot.see(b=True)
    assert robot.actual("carrier") == "finalized"


def test_a_part_that_nobody_asked_for_anything_is_not_activated() -> None:
    robot = ReactingRobot(LIMP, asked=False).see(a=True)

    assert robot.target() == "none"
    assert robot.why("LIMP")[0].startswith("nothing was requested of carrier")
    assert robot.refusal_of("carrier", "FAST").code == "REACTION"
    robot.ask_mode("carrier", "SLOW")
    robot.advance(1)
    assert robot.target() == "active.SLOW by reaction LIMP"


# --- ESTOP, the backend --------------------------------------------------------------------------


def test_under_estop_nothing_is_activated_and_nothing_is_made_up_for() -> None:
    robot = ReactingRobot(of_lidar='WAKE: {when: "a", action: state, target: active}', asked=False)
    robot.ask_transition("lidar", "configure")
    robot.advance(1)
    robot.stop()
    robot.see(a=True)
    assert robot.actual("lidar") == "inactive"
    robot.release_stop()
    robot.see(a=True)
    assert robot.actual("lidar") == "inactive"


def test_under_estop_a_part_may_slow_down_or_rest() -> None:
    robot = ReactingRobot(LIMP, REST)
    robot.stop()
    robot.see(a=True)
    assert robot.actual("carrier") == "active.SLOW"
    robot.see(b=True)
    assert robot.actual("carrier") == "inactive"
    robot.see(b=False)
    assert robot.state("LIMP") == "overruled", "it would activate"
    assert robot.actual("carrier") == "inactive"


def test_what_ends_under_estop_stays_until_somebody_asks() -> None:
    robot = ReactingRobot(REST).see(b=True)
    robot.stop()
    robot.see(b=False)
    robot.release_stop()
    robot.wait(2)
    assert robot.target() == "inactive by reaction REST"
    assert robot.state("REST") == "idle"
    robot.ask_mode("carrier", "FAST")
    robot.advance(1)
    assert robot.target() == "active.FAST"


def test_while_the_backend_is_down_nothing_moves_and_then_it_does() -> None:
    robot = ReactingRobot(LIMP)
    robot.give(BackendStatus(available=False, reason="gone"))
    robot.see(a=True)
    assert robot.target() == "active.FAST"
    robot.give(BackendStatus(available=True))
    robot.advance(1)
    assert robot.target() == "active.SLOW by reaction LIMP"
    robot.give(BackendStatus(available=False, reason="gone"))
    robot.see(a=False)
    assert robot.target() == "active.SLOW by reaction LIMP"
    robot.give(BackendStatus(available=True))
    robot.wait(1.5)
    assert robot.target() == "active.FAST"


# --- acknowledging, arming -----------------------------------------------------------------------


def test_a_reaction_may_last_until_somebody_acknowledges_it() -> None:
    robot = ReactingRobot('HALT: {when: "c", action: hold, until: acknowledged}').see(c=True)
    robot.see(c=False)
    assert robot.holds == ["reaction:HALT"]
    assert robot.reaction("HALT").waits_for == "an acknowledgement"
    robot.acknowledge_reaction("HALT")
    assert robot.holds == []
    assert robot.told("HALT") == ["acting", "ended"]


def test_an_acknowledgement_counts_once_the_condition_is_over_and_not_if_it_comes_again() -> None:
    robot = ReactingRobot('HALT: {when: "c", action: hold, until: acknowledged}').see(c=True)
    robot.acknowledge_reaction("HALT")
    assert robot.holds == ["reaction:HALT"]
    robot.see(c=False)
    assert robot.holds == []
    robot.see(c=True).see(c=False)
    assert robot.holds == ["reaction:HALT"]


def test_a_disarmed_reaction_does_nothing_and_an_armed_one_acts_at_once() -> None:
    robot = ReactingRobot(LIMP)
    robot.arm("LIMP", "disarmed")
    robot.see(a=True)
    assert (robot.target(), robot.state("LIMP")) == ("active.FAST", "idle")
    robot.arm("LIMP", "active")
    assert robot.target() == "active.SLOW by reaction LIMP"
    robot.arm("LIMP", "disarmed")
    assert robot.target() == "active.FAST"
    assert robot.told("LIMP") == ["acting", "ended"]
    assert robot.reaction("LIMP").arm is Arm.DISARMED


def test_a_passive_reaction_tells_when_it_would_act_and_does_nothing() -> None:
    robot = ReactingRobot('LIMP: {when: "a", action: mode, target: active.SLOW, arm: passive}')
    robot.see(a=True)
    assert (robot.target(), robot.state("LIMP")) == ("active.FAST", "passive")
    robot.ask_mode("carrier", "FAST")
    robot.see(a=False)
    assert robot.told("LIMP") == ["would_act"]


def test_a_passive_hold_holds_nothing() -> None:
    robot = ReactingRobot('HALT: {when: "c", action: hold, arm: passive}').see(c=True)

    assert robot.holds == []
    assert robot.told("HALT") == ["would_act"]


def test_arming_anew_as_it_is_changes_nothing() -> None:
    robot = ReactingRobot(LIMP)
    robot.arm("LIMP", "active")

    assert robot.happened("reaction.arm_requested") == []


def test_an_unknown_reaction_is_told() -> None:
    robot = ReactingRobot(LIMP)
    with pytest.raises(UnknownReactionError, match="carrier"):
        robot.arm("NONE", "active")
    with pytest.raises(UnknownReactionError, match="lidar"):
        robot.acknowledge_reaction("LIMP", "lidar")


# --- holds of others -----------------------------------------------------------------------------


def test_nobody_else_sets_or_releases_the_hold_of_a_reaction() -> None:
    robot = ReactingRobot(HALT).see(c=True)
    with pytest.raises(ReservedHoldError):
        robot.give(ReleaseRequest("reaction:HALT"))
    with pytest.raises(ReservedHoldError):
        robot.give(HoldRequest("reaction:ANY", "mine"))

    assert robot.holds == ["reaction:HALT"]


# --- what a copy of the robot has ----------------------------------------------------------------


def test_a_copy_of_a_robot_goes_on_with_its_reactions() -> None:
    robot = ReactingRobot(LIMP, HALT, REST).see(a=True, c=True)
    copy = core_of_checkpoint(checkpoint_of(robot.onboard, "1"), "1")
    robot.onboard, robot.core = copy, copy.core
    robot.see(b=True, c=False)

    assert robot.target() == "inactive by reaction REST"
    assert (robot.state("LIMP"), robot.holds) == ("overruled", [])


def test_each_event_leads_back_to_the_input_that_brought_it_about() -> None:
    robot = ReactingRobot(LIMP, REST).see(a=True).see(b=True)
    robot.see(b=False)

    events = {event.id: event for event in robot.events}
    last = [event for event in robot.events if event.kind.startswith("reaction.")][-2:]
    assert [event.kind for event in last] == ["reaction.acting", "reaction.ended"]
    for event in last:
        cause = events[event.cause or 0]
        assert cause.kind == "signal.read"
        assert "'b': False" in str(cause.data["values"])
