"""Budgets: how often a reaction moves its part, and what it does then."""

from tests.support.reacting_robot import HALT, LIMP, ReactingRobot

TWICE = (
    'LIMP: {when: "a", action: mode, target: active.SLOW, at_most: 2, in_s: 10, on_exhausted: stop}'
)


def used_up(reaction: str = TWICE) -> ReactingRobot:
    robot = ReactingRobot(reaction)
    for _ in range(2):
        robot.see(a=True).see(a=False)
    return robot


def test_a_reaction_that_acted_too_often_stops_the_robot_until_somebody_acknowledges() -> None:
    robot = used_up().see(a=True)

    assert (robot.state("LIMP"), robot.target()) == ("exhausted", "active.FAST")
    assert robot.holds == ["reaction:LIMP"]
    robot.see(a=False)
    assert robot.holds == ["reaction:LIMP"]
    robot.acknowledge_reaction("LIMP")
    assert robot.holds == []
    assert robot.told("LIMP") == ["acting", "ended", "acting", "ended", "exhausted", "ended"]


def test_an_acknowledged_reaction_has_its_full_budget_again() -> None:
    robot = used_up().see(a=True)
    robot.acknowledge_reaction("LIMP")

    assert (robot.state("LIMP"), robot.reaction("LIMP").left) == ("acting", 1)


def test_what_is_longer_ago_than_the_file_says_counts_no_more() -> None:
    robot = used_up()
    assert robot.reaction("LIMP").left == 0
    robot.wait(6)
    assert robot.reaction("LIMP").left == 1
    robot.see(a=True)
    assert robot.state("LIMP") == "acting"


def test_a_frame_tells_when_a_reaction_may_act_again() -> None:
    robot = used_up()
    robot.advance(5.999)
    outputs = robot.read(battery_level=1.0)
    assert "carrier.LIMP" not in outputs.reactions
    robot.now += 1_000_000
    assert "carrier.LIMP" in robot.read(battery_level=1.0).reactions


def test_an_exhausted_reaction_keeps_nobody_else_from_acting() -> None:
    crawl = 'CRAWL: {when: "a", action: mode, target: active.CRAWL}'
    robot = ReactingRobot(TWICE.replace("at_most: 2", "at_most: 1"), crawl)
    robot.see(a=True).see(a=False).see(a=True)

    assert robot.target() == "active.CRAWL by reaction CRAWL"


def test_a_reaction_that_begins_again_at_the_same_moment_counts_as_too_often() -> None:
    robot = ReactingRobot(LIMP)
    robot.see(0, a=True).see(0, a=False).see(0, a=True)

    assert robot.state("LIMP") == "exhausted"


def test_holds_have_no_budget() -> None:
    robot = ReactingRobot(HALT)
    for _ in range(5):
        robot.see(c=True).see(c=False)

    assert robot.reaction("HALT").left is None
    assert robot.told("HALT") == ["acting", "ended"] * 5


def test_a_passive_reaction_uses_its_budget_up_silently() -> None:
    robot = used_up(TWICE[:-1] + ", arm: passive}").see(a=True)

    assert (robot.state("LIMP"), robot.holds) == ("exhausted", [])
    assert robot.told("LIMP") == ["would_act", "would_act"]


def test_arming_a_reaction_refills_its_budget() -> None:
    robot = used_up().see(a=True)
    robot.arm("LIMP", "passive")
    assert robot.holds == []
    robot.arm("LIMP", "active")
    assert robot.state("LIMP") == "acting"
