"""Escalations: another reaction is called for when one has no effect in time."""

from domain.simulation.node_settings import Fault
from tests.support.reacting_robot import ReactingRobot

LIMP = (
    'LIMP: {when: "a", action: mode, target: active.SLOW, escalate_after_s: 3, escalate_to: HALT}'
)
HALT = 'HALT: {when: "false", action: hold}'


def test_a_mode_that_is_not_reached_in_time_leads_to_another_reaction() -> None:
    robot = ReactingRobot(LIMP, HALT)
    robot.fault("drive", Fault.SILENT)
    robot.see(a=True)
    assert robot.holds == []
    robot.advance(2)
    assert robot.holds == ["reaction:HALT"]
    assert robot.why("HALT") == ["reaction LIMP of carrier had no effect within 3 s"]
    hold = robot.happened("hold.set")[-1]
    assert hold["reason"] == "carrier: reaction LIMP had no effect (carrier: a)"
    assert robot.reaction("HALT").waits_for == "an end of: reaction LIMP"


def test_a_mode_that_is_reached_in_time_leads_to_nothing() -> None:
    robot = ReactingRobot(LIMP, HALT).see(a=True)
    robot.advance(10)

    assert robot.state("HALT") == "idle"


def test_an_escalation_lasts_until_its_reaction_is_over() -> None:
    robot = ReactingRobot(LIMP, HALT)
    robot.fault("drive", Fault.SILENT)
    robot.see(a=True).advance(3)
    robot.fault("drive", None)
    robot.advance(3)
    assert robot.holds == ["reaction:HALT"]
    robot.see(a=False)
    assert robot.holds == []


def test_a_stronger_reaction_takes_over_and_the_escalation_lasts() -> None:
    limp = LIMP.replace("HALT", "REST")
    robot = ReactingRobot(limp, 'REST: {when: "false", action: state, target: inactive}')
    robot.fault("drive", Fault.SILENT)
    robot.see(a=True).advance(3)

    assert robot.target() == "inactive by reaction REST"
    assert (robot.state("LIMP"), robot.state("REST")) == ("overruled", "acting")
    robot.see(a=False)
    assert robot.state("REST") == "idle"


def test_what_only_tells_escalates_as_long_as_it_is_so() -> None:
    tell = 'TELL: {when: "a", action: tell, escalate_after_s: 2, escalate_to: HALT}'
    robot = ReactingRobot(tell, HALT).see(a=True)
    assert robot.holds == []
    robot.advance(1)
    assert robot.holds == ["reaction:HALT"]


def test_a_hold_has_its_effect_once_the_vehicle_stands() -> None:
    hold = 'WAIT: {when: "a", action: hold, escalate_after_s: 1, escalate_to: KILL}'
    robot = ReactingRobot(hold, 'KILL: {when: "false", action: emergency_stop}').see(a=True)
    robot.wait(3)

    assert not robot.core.emergency_stop().engaged


def test_an_escalation_may_be_that_of_several_reactions() -> None:
    one = 'ONE: {when: "a", action: tell, escalate_after_s: 1, escalate_to: HALT}'
    other = 'OTHER: {when: "b", action: tell, escalate_after_s: 1, escalate_to: HALT}'
    robot = ReactingRobot(one, other, HALT).see(a=True, b=True).see(a=False)
    assert robot.holds == ["reaction:HALT"]
    robot.see(b=False)
    assert robot.holds == []


def test_an_effect_may_be_wanted_at_once() -> None:
    tell = 'TELL: {when: "a", action: tell, escalate_after_s: 0, escalate_to: HALT}'

    assert ReactingRobot(tell, HALT).see(0, a=True).holds == ["reaction:HALT"]
