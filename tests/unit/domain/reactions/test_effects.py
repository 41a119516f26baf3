"""What reactions do besides moving parts: they tell, hold the task, and stop the robot."""

from domain.commands import Drive
from tests.support.reacting_robot import HALT, ReactingRobot


def test_a_hold_stops_the_task_and_its_end_lets_it_go_on() -> None:
    robot = ReactingRobot(HALT)
    robot.submit_task()
    robot.advance(1)
    robot.see(c=True)
    assert robot.task.status in ("PAUSING", "PAUSED")
    assert robot.holds == ["reaction:HALT"]
    assert robot.core.driving.holds["reaction:HALT"].reason == "carrier: c"
    robot.see(c=False)
    assert robot.task.status == "RUNNING"


def test_a_stop_commands_speed_0_and_keeps_tasks_from_going_on() -> None:
    robot = ReactingRobot('STOP: {when: "c", action: stop}')
    robot.submit_task()
    robot.advance(2)
    robot.see(0, c=True)
    driven = [command for command in robot.commands if isinstance(command, Drive)]
    assert driven[-1].command.speed_mps == 0
    robot.drop_task()
    robot.submit_task()
    robot.advance(1)
    assert robot.task.status in ("PAUSING", "PAUSED")


def test_the_event_of_a_hold_leads_back_to_the_reading() -> None:
    robot = ReactingRobot(HALT).see(c=True)

    events = {event.id: event for event in robot.events}
    held = next(event for event in robot.events if event.kind == "hold.set")
    assert held.actor.label == "reaction:HALT"
    acting = events[held.cause or 0]
    assert acting.kind == "reaction.acting"
    assert events[acting.cause or 0].kind == "signal.read"


def test_an_emergency_stop_is_engaged_once_and_released_by_a_person() -> None:
    robot = ReactingRobot('KILL: {when: "c", action: emergency_stop}').see(c=True)
    stop = robot.core.emergency_stop()
    assert (stop.engaged, stop.by, stop.reason) == (True, "reaction:KILL", "carrier: c")
    robot.release_stop()
    robot.see(c=True)
    assert not robot.core.emergency_stop().engaged, "a person decides"
    robot.see(c=False).see(c=True)
    assert robot.core.emergency_stop().engaged


def test_an_emergency_stop_outlasts_its_cause() -> None:
    robot = ReactingRobot('KILL: {when: "c", action: emergency_stop}').see(c=True).see(c=False)

    assert robot.core.emergency_stop().engaged
    assert robot.state("KILL") == "idle"


def test_who_tells_does_nothing_else() -> None:
    robot = ReactingRobot('TELL: {when: "a or b", action: tell}').see(a=True)
    (acting,) = [event for event in robot.events if event.kind == "reaction.acting"]

    assert acting.data["reason"] == "a is true, needs false"
    assert robot.holds == []
    assert robot.told("TELL") == ["acting"]


def test_the_words_say_what_calls_for_a_reaction_and_what_keeps_it() -> None:
    rest = 'REST: {when: "a and b", action: state, target: inactive}'
    robot = ReactingRobot(rest, 'LIMP: {when: "a", action: mode, target: active.SLOW}')
    robot.see(a=True).see(b=True)
    words = [event.event.words for event in robot.events if event.kind.startswith("reaction.")]

    assert words == [
        "reaction LIMP of carrier: mode: a is true, needs false",
        "reaction REST of carrier: state: a is true, needs false; b is true, needs false",
        "reaction LIMP of carrier is overruled: reaction REST of carrier is stronger",
    ]
