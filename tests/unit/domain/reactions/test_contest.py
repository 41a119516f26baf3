"""Which reactions act, decided anew from the same things each time."""

from domain.reactions.contest import claim_of
from tests.support.reacting_robot import HALT, LIMP, REST, ReactingRobot

CRAWL = 'CRAWL: {when: "a", action: mode, target: active.CRAWL}'


def test_the_order_of_strength_is_that_of_the_actions_and_then_of_the_file() -> None:
    robot = ReactingRobot(CRAWL, LIMP, REST, HALT).see(a=True, b=True, c=True)

    states = {view.reaction: str(view.state) for view in robot.core.reactions().values()}
    assert states == {
        "CRAWL": "overruled",
        "LIMP": "overruled",
        "REST": "acting",
        "HALT": "acting",
    }


def test_the_order_in_which_causes_came_does_not_matter() -> None:
    one = ReactingRobot(LIMP, REST).see(a=True).see(b=True)
    other = ReactingRobot(LIMP, REST).see(b=True).see(a=True)

    assert one.target() == other.target() == "inactive by reaction REST"


def test_a_passive_reaction_would_act_where_no_active_one_is_stronger() -> None:
    robot = ReactingRobot(LIMP, REST[:-1] + ", arm: passive}").see(a=True).see(b=True)
    assert (robot.state("LIMP"), robot.state("REST")) == ("acting", "passive")
    robot.arm("REST", "active")
    assert (robot.state("LIMP"), robot.state("REST")) == ("overruled", "acting")
    robot.arm("LIMP", "passive")
    assert robot.state("LIMP") == "overruled"


def test_a_passive_reaction_claims_nothing() -> None:
    robot = ReactingRobot(LIMP[:-1] + ", arm: passive}").see(a=True)

    robot.ask_mode("carrier", "FAST")


def test_what_requests_are_refused_by_is_the_strongest_of_each_part() -> None:
    robot = ReactingRobot(LIMP, CRAWL).see(a=True)

    assert robot.refusal_of("carrier", "CRAWL").message == "reaction LIMP of carrier: a"


def test_a_claim_has_the_targets_of_all_parts_below() -> None:
    robot = ReactingRobot(LIMP)
    (reaction,) = robot.core._reactions._reactions  # noqa: SLF001 (what it is made of)

    assert {part: target.label for part, target in claim_of(reaction).targets.items()} == {
        "carrier": "active.SLOW",
        "lidar": "active",
        "drive": "active.SLOW",
    }
