"""Reactions that a device decides about, told as the operator of the supervisor sees them."""

import pytest

from domain.actor import Actor
from domain.errors import ActsElsewhereError, BlockedError
from domain.inputs import (
    AcknowledgeReactionRequest,
    ArmRequest,
    ModeRequest,
    ReactionReport,
)
from domain.reaction_terms import Arm, ReactionState
from domain.state_and_mode import PartName
from tests.support.following_robot import CALM, DRIVE, FollowingRobot
from tests.support.good import GOOD
from tests.support.reacting_robot import LIMP

STOP = 'STOP: {when: "a", action: emergency_stop}'


def test_the_supervisor_does_not_act_in_the_place_of_the_device() -> None:
    robot = FollowingRobot()

    robot.read(**GOOD, a=True)
    robot.advance(5)

    assert robot.asked == []
    assert robot.target() == "active.FAST by requested"


def test_what_the_device_does_is_shown_with_its_reaction_and_not_done_twice() -> None:
    robot = FollowingRobot()

    robot.hear("acting")
    robot.slow_down()

    assert robot.target() == "active.SLOW by local CALM"
    assert robot.core.reaction("drive.CALM").state is ReactionState.ACTING
    assert robot.asked == []
    assert robot.happened("part.deviates") == []


def test_the_log_leads_from_what_the_device_told_to_the_target() -> None:
    robot = FollowingRobot()

    robot.hear("acting")

    by_id = {event.id: event for event in robot.events}
    (began,) = [event for event in robot.events if event.kind == "target.displacement_began"]
    acting = by_id[began.cause or 0]
    told = by_id[acting.cause or 0]
    assert (acting.kind, told.kind) == ("reaction.acting", "reaction.reported")


def test_the_supervisor_leads_back_once_the_reaction_has_ended() -> None:
    robot = FollowingRobot()
    robot.hear("acting")
    robot.slow_down()

    robot.hear("idle")
    robot.advance(1)

    assert robot.target() == "active.FAST by requested"
    assert robot.actual("drive") == "active.FAST"


def test_nothing_leads_back_under_a_stop() -> None:
    robot = FollowingRobot()
    robot.hear("acting")
    robot.slow_down()
    robot.stop()

    robot.hear("idle")
    robot.advance(1)

    assert robot.asked == []


def test_a_request_against_the_reaction_is_refused() -> None:
    robot = FollowingRobot()
    robot.hear("acting")

    with pytest.raises(BlockedError) as caught:
        robot.give(ModeRequest(DRIVE, "FAST"))

    assert caught.value.blockers[0].code == "REACTION"


def test_a_part_of_a_device_comes_to_rest_whatever_its_reaction_does() -> None:
    robot = FollowingRobot()
    robot.hear("acting")

    robot.ask_transition("drive", "deactivate")
    robot.advance(1)

    assert robot.actual("drive") == "inactive"


def test_a_reaction_of_the_supervisor_leaves_alone_what_the_device_moves() -> None:
    robot = FollowingRobot(CALM, 'LIMP: {when: "b", action: mode, target: active.CRAWL}')
    robot.hear("acting")
    robot.slow_down()

    robot.read(**GOOD, b=True)
    robot.advance(2)

    assert robot.target("carrier") == "active.CRAWL by reaction LIMP"
    assert robot.target("drive") == "active.SLOW by local CALM"
    assert robot.actual("drive") == "active.SLOW"


def test_reactions_of_the_supervisor_itself_act_as_ever() -> None:
    robot = FollowingRobot(CALM, LIMP)

    robot.read(**GOOD, a=True)
    robot.advance(1)

    assert robot.target("carrier") == "active.SLOW by reaction LIMP"
    assert robot.actual("drive") == "active.SLOW"


def test_the_stop_that_a_device_engages_is_its_own() -> None:
    robot = FollowingRobot(STOP)

    robot.hear("acting")

    assert not robot.core.emergency_stop().engaged
    assert robot.core.reaction("drive.STOP").state is ReactionState.ACTING


def test_a_reaction_that_acted_too_often_on_its_device_holds_the_task_here() -> None:
    robot = FollowingRobot()

    robot.hear("exhausted")
    assert "reaction:CALM" in robot.core.driving.holds

    robot.hear("idle")
    assert "reaction:CALM" not in robot.core.driving.holds


@pytest.mark.parametrize(
    "given",
    [
        ArmRequest(DRIVE, "CALM", Arm.DISARMED, "test", Actor("operator")),
        AcknowledgeReactionRequest(DRIVE, "CALM", Actor("operator")),
    ],
)
def test_who_arms_or_acknowledges_is_sent_to_the_device(
    given: ArmRequest | AcknowledgeReactionRequest,
) -> None:
    robot = FollowingRobot()

    with pytest.raises(ActsElsewhereError, match="reaction CALM acts on device base"):
        robot.give(given)


@pytest.mark.parametrize(("part", "name"), [("drive", "LIMP"), ("carrier", "CALM"), ("drive", "X")])
def test_a_device_tells_nothing_of_reactions_that_are_not_its_own(part: str, name: str) -> None:
    robot = FollowingRobot(CALM, LIMP)
    before = len(robot.events)

    robot.give(ReactionReport(PartName(part), name, ReactionState.ACTING))

    assert len(robot.events) == before


def test_what_is_told_twice_is_one_event() -> None:
    robot = FollowingRobot()
    robot.hear("acting")
    before = len(robot.events)

    robot.hear("acting")

    assert len(robot.events) == before


def test_a_restart_of_the_supervisor_forgets_nothing_and_moves_nothing() -> None:
    robot = FollowingRobot()
    robot.hear("acting")
    robot.slow_down()

    robot.restart()
    robot.advance(5)

    assert robot.target() == "active.SLOW by local CALM"
    assert robot.core.reaction("drive.CALM").state is ReactionState.ACTING
    assert robot.asked == []


def test_after_a_restart_the_end_of_the_reaction_leads_nowhere_until_somebody_asks() -> None:
    robot = FollowingRobot()
    robot.hear("acting")
    robot.slow_down()
    robot.restart()

    robot.hear("idle")
    robot.advance(5)

    assert robot.core.reaction("drive.CALM").state is ReactionState.IDLE
    assert robot.asked == []
