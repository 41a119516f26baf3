"""What a restart of the service leaves of reactions."""

from domain.commands import AskFacts
from domain.kept import KeptReaction
from tests.support.reacting_robot import HALT, LIMP, REST, ReactingRobot

TWICE = 'LIMP: {when: "a", action: mode, target: active.SLOW, at_most: 2, in_s: 10}'


def test_a_target_that_a_reaction_set_is_in_force_again_and_nothing_moves() -> None:
    robot = ReactingRobot(LIMP).see(a=True).come_back()

    assert robot.target() == "active.SLOW by reaction LIMP"
    assert robot.state("LIMP") == "acting"
    assert not [command for command in robot.commands if not isinstance(command, AskFacts)]
    assert robot.told("LIMP") == []


def test_it_ends_once_its_condition_is_known_to_be_false() -> None:
    robot = ReactingRobot(LIMP).see(a=True).come_back().see(a=False)
    assert robot.state("LIMP") == "idle"
    assert robot.target() == "active.SLOW by reaction LIMP", "nothing returns by itself"
    robot.ask_mode("carrier", "FAST")
    robot.advance(1)
    assert robot.target() == "active.FAST"


def test_after_a_restart_a_reaction_activates_nothing_until_somebody_asks() -> None:
    robot = ReactingRobot(LIMP, REST).see(b=True)
    robot.come_back().see(a=True, b=True).see(b=False)
    assert robot.actual("carrier") == "inactive"
    assert robot.why("LIMP")[0].startswith("the service was restarted")
    robot.ask_mode("carrier", "SLOW")
    robot.advance(1)
    assert robot.target() == "active.SLOW by reaction LIMP"


def test_after_a_restart_a_reaction_may_still_bring_to_rest() -> None:
    robot = ReactingRobot(REST).come_back().see(b=True)

    assert robot.actual("carrier") == "inactive"


def test_a_node_that_a_reaction_restarted_is_not_restarted_once_more() -> None:
    again = 'AGAIN: {when: "a", action: restart}'
    robot = ReactingRobot(of_lidar=again).see(3, a=True)
    assert robot.actual("lidar") == "active"

    robot.come_back().see(3, a=True)
    assert (robot.state("AGAIN", "lidar"), robot.actual("lidar")) == ("acting", "active")
    assert robot.happened("change.step_started") == []

    robot.ask_mode("carrier", "FAST")
    robot.see(a=False).see(3, a=True)
    assert len(robot.happened("change.step_started")) == 4
    assert robot.actual("lidar") == "active"


def test_a_budget_is_not_refilled_by_a_restart_however_long_it_takes() -> None:
    robot = ReactingRobot(TWICE)
    for _ in range(2):
        robot.see(a=True).see(a=False)
    robot.come_back(3_600)
    assert robot.reaction("LIMP").left == 0
    robot.ask_mode("carrier", "FAST")
    robot.see(a=True)
    assert robot.state("LIMP") == "exhausted"
    robot.come_back()
    assert (robot.state("LIMP"), robot.holds) == ("exhausted", ["reaction:LIMP"])
    robot.wait(20)
    assert robot.state("LIMP") == "exhausted"
    robot.acknowledge_reaction("LIMP")
    assert robot.holds == []


def test_a_budget_that_ran_down_before_a_restart_is_full_after_it() -> None:
    robot = ReactingRobot(TWICE).see(a=True).see(a=False).wait(12)

    assert robot.come_back().reaction("LIMP").left == 2
    assert not [kind for kind, _ in robot.kept if kind is KeptReaction]


def test_a_hold_is_there_again_and_ends_with_its_condition() -> None:
    robot = ReactingRobot(HALT).see(c=True).come_back()
    assert robot.holds == ["reaction:HALT"]
    robot.see(c=False)
    assert "reaction:HALT" not in robot.holds


def test_what_waits_for_an_acknowledgement_still_does() -> None:
    halt = 'HALT: {when: "c", action: hold, until: acknowledged}'
    robot = ReactingRobot(halt).see(c=True).see(c=False).come_back().see(c=False)
    assert "reaction:HALT" in robot.holds
    robot.acknowledge_reaction("HALT")
    assert "reaction:HALT" not in robot.holds


def test_an_acknowledgement_that_was_given_early_still_counts() -> None:
    robot = ReactingRobot('HALT: {when: "c", action: hold, until: acknowledged}').see(c=True)
    robot.acknowledge_reaction("HALT")

    assert "reaction:HALT" not in robot.come_back().see(c=False).holds


def test_what_an_operator_armed_stays_so() -> None:
    robot = ReactingRobot(LIMP)
    robot.arm("LIMP", "disarmed")
    robot.come_back().see(a=True)
    assert (robot.reaction("LIMP").arm, robot.state("LIMP")) == ("disarmed", "idle")


def test_a_passive_reaction_does_not_tell_again_what_it_told() -> None:
    passive = LIMP[:-1] + ", arm: passive}"
    robot = ReactingRobot(passive).see(a=True).come_back().see(a=True)

    assert robot.state("LIMP") == "passive"
    assert robot.told("LIMP") == []


def test_an_escalation_lasts() -> None:
    tell = 'TELL: {when: "a", action: tell, escalate_after_s: 1, escalate_to: HALT}'
    halt = 'HALT: {when: "false", action: hold}'
    robot = ReactingRobot(tell, halt).see(2, a=True).come_back()
    assert "reaction:HALT" in robot.holds
    robot.see(a=False)
    assert "reaction:HALT" not in robot.holds


def test_a_reaction_that_the_model_no_longer_has_is_left_out_and_told() -> None:
    robot = ReactingRobot(LIMP).see(a=True)
    robot.model = ReactingRobot(REST).model
    robot.come_back()

    told = [data["what"] for data in robot.happened("service.not_restored")]
    assert "the reaction LIMP of carrier" in told
    assert "the target active.SLOW of carrier that a reaction set" in told
    assert not [kind for kind, _ in robot.kept if kind is KeptReaction]
    assert robot.target() == "active.FAST"
