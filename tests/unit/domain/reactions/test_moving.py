"""Targets that reactions set, and how parts return."""

from domain.kept import KeptEffectiveTarget
from tests.support.reacting_robot import LIMP, REST, ReactingRobot


def changes(robot: ReactingRobot) -> list[tuple[str, str]]:
    return [(c.request.actor.label, str(c.status)) for c in reversed(robot.core.changes())][1:]


def test_changes_lead_there_and_back_in_the_name_of_the_reaction() -> None:
    robot = ReactingRobot(LIMP).see(a=True).see(a=False)

    assert changes(robot) == [("reaction:LIMP", "succeeded")] * 2


def test_a_reaction_that_ends_early_supersedes_its_own_change() -> None:
    robot = ReactingRobot(REST).see(0.1, b=True).see(3, b=False)

    assert [status for _, status in changes(robot)] == ["superseded", "succeeded"]
    assert robot.actual("carrier") == "active.FAST"


def test_a_part_without_a_requested_target_stays_where_it_was_led() -> None:
    robot = ReactingRobot(
        of_lidar='REST: {when: "b", action: state, target: inactive}', asked=False
    )
    robot.see(b=True).see(b=False)

    assert robot.actual("lidar") == "inactive"
    assert robot.target("lidar") == "none"


def test_a_target_that_is_kept_is_forgotten_when_it_ends() -> None:
    robot = ReactingRobot(LIMP).see(a=True)
    assert [kind for kind, _ in robot.kept if kind is KeptEffectiveTarget]
    robot.see(a=False)
    assert not [kind for kind, _ in robot.kept if kind is KeptEffectiveTarget]


def test_a_part_that_may_not_return_yet_is_told_why_and_returns_later() -> None:
    robot = ReactingRobot(LIMP, settings='{FAST: {requires: "not b"}}').see(a=True)
    robot.see(a=False, b=True)
    pursued = robot.core.part(robot.model.parts[0]).effective_target
    assert pursued is not None
    assert robot.target() == "active.SLOW by reaction LIMP"
    assert pursued.blockers[0].message == "b is true, needs false"
    robot.see(2, b=False)
    assert robot.target() == "active.FAST"


def test_a_reaction_that_is_called_for_again_before_its_part_returned_goes_on() -> None:
    robot = ReactingRobot(LIMP, settings='{FAST: {requires: "not b"}}').see(a=True)
    robot.see(a=False, b=True).see(a=True).see(2, b=False)

    assert robot.target() == "active.SLOW by reaction LIMP"
    assert robot.state("LIMP") == "acting"


def test_a_part_that_was_to_return_from_one_reaction_stays_with_the_next() -> None:
    crawl = 'CRAWL: {when: "c", action: mode, target: active.CRAWL}'
    robot = ReactingRobot(LIMP, crawl, settings='{FAST: {requires: "not b"}}').see(a=True)
    robot.see(a=False, b=True)
    assert robot.target() == "active.SLOW by reaction LIMP", "FAST may not be entered yet"
    robot.see(c=True)
    assert robot.target() == "active.CRAWL by reaction CRAWL"

    robot.see(3, b=False)
    assert robot.target() == "active.CRAWL by reaction CRAWL"
    robot.see(3, c=False)
    assert robot.target() == "active.FAST"


def test_what_is_shown_as_the_cause_is_what_calls_for_it_now() -> None:
    robot = ReactingRobot('LIMP: {when: "a or b", action: mode, target: active.SLOW}')
    robot.see(a=True).see(b=True).see(a=False)

    pursued = robot.core.part(robot.model.parts[0]).effective_target
    assert pursued is not None
    (tree,) = pursued.blockers[0].causes
    assert [cause.message for cause in tree.causes] == ["b is true, needs false"]
