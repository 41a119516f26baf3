"""What keeps a reaction from acting."""

from tests.support.reacting_robot import LIMP, ReactingRobot


def test_a_mode_whose_requirements_do_not_hold_is_not_entered_until_they_do() -> None:
    robot = ReactingRobot(LIMP, settings='{SLOW: {requires: "not b"}}').see(b=True).see(a=True)
    assert (robot.state("LIMP"), robot.target()) == ("overruled", "active.FAST")
    assert robot.why("LIMP")[0] == "b is true, needs false"
    robot.see(b=False)
    assert robot.target() == "active.SLOW by reaction LIMP"
    robot.see(b=True)
    assert robot.target() == "active.SLOW by reaction LIMP", "it is needed for entering only"


def test_an_invariant_that_breaks_counts_after_its_grace() -> None:
    guarded = '{SLOW: {invariants: "not b", grace_s: 2}}'
    robot = ReactingRobot(LIMP, settings=guarded).see(a=True).see(1.9, b=True)
    assert robot.state("LIMP") == "acting"
    robot.advance(0.2)
    assert (robot.state("LIMP"), robot.target()) == ("overruled", "active.FAST")


def test_a_fallback_replaces_what_is_in_force_below_a_reaction_that_gave_way() -> None:
    settings = '{SLOW: {invariants: "not b"}, FAST: {invariants: "not b", fallback: CRAWL}}'
    robot = ReactingRobot(LIMP, settings=settings).see(a=True).see(b=True)

    assert robot.target() == "active.CRAWL by invariant"


def test_an_invariant_of_a_part_below_raises_its_error_and_no_more() -> None:
    settings = '{SLOW: {invariants: "not b", fallback: CRAWL}}'
    robot = ReactingRobot(LIMP, drive_settings=settings).see(a=True).see(b=True)

    assert robot.target("drive") == "active.SLOW by reaction LIMP"
    assert "drive.INVARIANT_BROKEN" in robot.core.open_errors()
