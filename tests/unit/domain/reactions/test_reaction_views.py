from tests.support.reacting_robot import HALT, LIMP, REST, ReactingRobot


def test_a_view_is_the_same_object_until_something_changes() -> None:
    robot = ReactingRobot(LIMP)
    before = robot.reaction("LIMP")
    robot.see(a=False)
    assert robot.reaction("LIMP") is before
    robot.see(a=True)
    assert robot.reaction("LIMP") is not before


def test_what_changed_is_told_by_name() -> None:
    robot = ReactingRobot(LIMP, HALT)

    assert robot.read(a=True).reactions == {"carrier.LIMP"}
    assert robot.read(a=True).reactions == frozenset()


def test_each_says_what_it_waits_for() -> None:
    late = 'LATE: {when: "a", for_s: 5, action: tell}'
    seen = 'SEEN: {when: "c", action: hold, until: acknowledged}'
    robot = ReactingRobot(LIMP, REST, late, seen)
    assert robot.reaction("LIMP").waits_for == "a"
    robot.see(a=True, b=True, c=True)
    assert robot.reaction("LIMP").waits_for == "an end of: reaction REST of carrier is stronger"
    assert robot.reaction("REST").waits_for == "an end of: b"
    assert robot.reaction("LATE").waits_for == "a, for 5 s"
    assert robot.reaction("SEEN").waits_for == "an end of: c, and an acknowledgement"
    robot.acknowledge_reaction("SEEN")
    assert robot.reaction("SEEN").waits_for == "an end of: c"
    robot.arm("LIMP", "disarmed")
    assert robot.reaction("LIMP").waits_for == "being armed"


def test_an_idle_reaction_has_no_reasons() -> None:
    robot = ReactingRobot(LIMP).see(a=True).see(a=False)

    assert robot.reaction("LIMP").blockers == ()


def test_a_view_has_its_name_among_all() -> None:
    robot = ReactingRobot(LIMP)

    assert list(robot.core.reactions()) == ["carrier.LIMP"]
    assert robot.core.reaction("carrier.LIMP") is robot.reaction("LIMP")
