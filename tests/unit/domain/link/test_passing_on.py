"""Two devices that do not hear each other learn of stops through the supervisor."""

from domain.commands import AskRelease
from domain.computers import SUPERVISOR, StopId
from domain.link.messages import Beat
from domain.link.passing_on import EVERY
from domain.timebase import to_seconds
from tests.support.linked_pair import ARM, BASE, LinkedRobot


def robot_of_devices_apart() -> LinkedRobot:
    """Return a robot whose devices hear the supervisor, but not each other."""
    robot = LinkedRobot((BASE, ARM))
    robot.way(BASE, ARM).is_cut = robot.way(ARM, BASE).is_cut = True
    robot.run(2)
    return robot


def passed_on(robot: LinkedRobot) -> list[Beat]:
    return [sent for _, _, sent in robot.sent if isinstance(sent, Beat) and sent.passed_on]


def test_a_stop_reaches_a_device_that_does_not_hear_the_one_on_which_it_is_engaged() -> None:
    robot = robot_of_devices_apart()
    robot.engage(robot.base, "b1")
    robot.run(0.15)
    assert robot.devices[ARM].stops_of(BASE) == {"b1"}

    robot.engage(robot.base)
    robot.run(0.15)
    assert robot.devices[ARM].stops_of(BASE) == set()


def test_as_long_as_no_stop_was_engaged_nothing_is_passed_on() -> None:
    robot = LinkedRobot((BASE, ARM))
    robot.run(5)

    assert passed_on(robot) == []


def test_a_beat_that_is_lost_is_made_up_for_a_second_later() -> None:
    robot = robot_of_devices_apart()
    robot.way(SUPERVISOR, ARM).is_cut = True
    robot.engage(robot.base, "b1")
    robot.run(0.15)
    robot.way(SUPERVISOR, ARM).is_cut = False
    robot.run(to_seconds(EVERY))

    assert robot.devices[ARM].stops_of(BASE) == {"b1"}


def test_the_stop_of_a_process_that_was_replaced_is_released_everywhere() -> None:
    robot = robot_of_devices_apart()
    robot.engage(robot.base, "b1")
    robot.run(1)
    robot.kill(robot.base)
    robot.run(2)
    assert robot.devices[ARM].stops_of(BASE) == {"b1"}

    robot.devices[BASE] = robot.start(BASE)
    robot.run(3)
    assert robot.devices[ARM].stops_of(BASE) == {"b1"}, "it may live, behind a broken cable"
    robot.tell(robot.supervisor, AskRelease(BASE, (StopId("b1"),)))
    robot.run(3)

    assert robot.supervisor.stops_of(BASE) == set()
    assert robot.devices[ARM].stops_of(BASE) == set()


def test_a_stop_of_a_computer_that_is_lost_stays_engaged() -> None:
    robot = robot_of_devices_apart()
    robot.engage(robot.base, "b1")
    robot.run(1)
    robot.kill(robot.base)
    robot.run(20)

    assert robot.devices[ARM].stops_of(BASE) == {"b1"}
    assert robot.supervisor.stops_of(BASE) == {"b1"}
