"""Supervision and navigation together: goals stay on board, and a hold is one step."""

import math

import pytest

from domain.actor import Actor
from domain.commands import Drive
from domain.computers import ComputerName
from domain.controller import ControllerFeedback, ControllerStatus
from domain.errors import InvalidValueError
from domain.identifiers import GoalId
from domain.inputs import ModeRequest, Reading, Readings, TaskRequest, TimePassed, VehicleReport
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.snapshot import TaskPhase
from domain.timebase import seconds
from domain.vehicle import Pose, VehicleState
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import ACTUATION, BASE, actuation_model
from tests.support.paths import straight
from tests.support.scripted_controller import ControlledRobot


@pytest.fixture
def robot() -> CoreRobot:
    robot = CoreRobot(SmhModel({}, {}))
    robot.read(**GOOD)
    robot.commands.clear()
    return robot


def drive(robot: CoreRobot, by_s: float) -> None:
    """Let time pass with good readings twice a second."""
    for _ in range(round(by_s / 0.5)):
        robot.advance(0.5)
        robot.read(**GOOD)


def speeds(robot: CoreRobot) -> list[float]:
    return [c.command.speed_mps for c in robot.commands if isinstance(c, Drive)]


def test_a_served_task_drives_in_the_same_step(robot: CoreRobot) -> None:
    outputs = robot.submit_task(straight())

    assert [type(command) for command in outputs.commands] == [Drive]
    assert speeds(robot) == [0.05]


def test_an_estop_while_driving_commands_zero_in_the_same_step(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    drive(robot, 3)
    outputs = robot.read(estop=True)

    assert [c.command.speed_mps for c in outputs.commands if isinstance(c, Drive)] == [0.0]
    assert outputs.system_state


def test_nothing_is_driven_while_the_task_is_held(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    drive(robot, 3)
    robot.hold()
    told = len(robot.commands)
    drive(robot, 3)

    assert {c.command.speed_mps for c in robot.commands[told:] if isinstance(c, Drive)} <= {0.0}
    stands = len(robot.commands)
    drive(robot, 3)
    assert robot.commands[stands:] == []


def test_the_whole_path_is_driven_and_the_vehicle_stands_at_its_end(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    drive(robot, 15)
    state = robot.core.driving.vehicle.state

    assert robot.task.status is TaskPhase.SUCCEEDED
    assert state is not None
    assert state.speed_mps == 0.0
    assert state.pose.x_m == pytest.approx(20.0, abs=0.3)


def test_the_goal_that_follows_a_lost_pose_is_steered_by_the_pose_that_is_back(
    robot: CoreRobot,
) -> None:
    robot.submit_task(straight())
    drive(robot, 3)
    robot.lose_pose()
    drive(robot, 2)
    robot.lose_pose(lost=False)
    drive(robot, 1)

    assert robot.task.status is TaskPhase.RUNNING
    assert [data["goal"] for data in robot.happened("task.resumed")] == [2]


def test_control_steps_that_are_due_before_an_input_are_done_before_it(
    robot: CoreRobot,
) -> None:
    robot.submit_task(straight())
    robot.commands.clear()
    outputs = robot.onboard.handle(TimePassed(), robot.now + seconds(0.2))

    assert len(outputs.commands) == 4


def test_a_refused_report_moves_neither_supervision_nor_navigation(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    nowhere = VehicleReport(VehicleState(Pose(0.0, math.inf, 0.0), 0.0, 0.0))
    with pytest.raises(InvalidValueError):
        robot.give(nowhere)
    drive(robot, 1)

    assert robot.task.status is TaskPhase.RUNNING


def test_what_was_driven_before_a_refusal_comes_with_the_next_call(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    later = robot.now + seconds(0.12)
    nowhere = VehicleReport(VehicleState(Pose(0.0, math.nan, 0.0), 0.0, 0.0))
    with pytest.raises(InvalidValueError):
        robot.onboard.handle(nowhere, later)

    assert len(robot.onboard.handle(TimePassed(), later).commands) == 2


def test_it_wakes_for_whichever_of_the_two_is_first(robot: CoreRobot) -> None:
    assert robot.onboard.wake_at() == robot.core.wake_at()
    robot.submit_task(straight())

    assert robot.onboard.wake_at() == robot.now + seconds(0.05)


def test_holds_between_waypoints_far_apart_leave_nothing_of_the_path_out(
    robot: CoreRobot,
) -> None:
    """What was driven before a hold was driven, though its next waypoint is still ahead."""
    robot.submit_task(straight(80.0, spacing_m=20.0))
    for _ in range(3):
        drive(robot, 7)
        robot.hold()
        drive(robot, 2)
        robot.release()
    drive(robot, 30)

    assert robot.task.status is TaskPhase.SUCCEEDED


def test_what_was_due_before_an_input_is_answered_together_with_it() -> None:
    """Whoever asks learns of all that happened meanwhile, and nothing is lost between."""
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    robot.submit_task(straight())
    later = robot.now + seconds(0.12)
    request = ModeRequest(BASE, "FAST", actor=Actor("alice"))
    outputs = robot.onboard.handle(request, later)

    assert outputs.change == "c1"
    assert outputs.parts == {BASE, ACTUATION}, "a system has not converged before its parts have"
    assert (outputs.task_changed, outputs.vehicle_changed) == (True, True)
    assert (outputs.task, outputs.system_state, outputs.signals) == (None, False, frozenset())
    kinds = [type(command).__name__ for command in outputs.commands]
    assert kinds == ["Drive", "Drive", "AskTransition"]


def test_a_task_that_is_served_late_is_told_with_its_id_and_the_state_that_follows() -> None:
    robot = CoreRobot(actuation_model())
    robot.read(**GOOD)
    robot.submit_task(straight())
    later = robot.now + seconds(0.12)
    outputs = robot.onboard.handle(TaskRequest(straight(), 0, "stanley", 2.8), later)

    assert outputs.task == "t2"
    assert outputs.change is None
    assert outputs.task_changed
    assert [event.kind for event in outputs.events if event.kind.startswith("task.")] == [
        "task.requested",
        "task.canceled",
        "task.served",
        "task.started",
    ]


def test_signals_that_changed_meanwhile_are_told_with_the_state_that_follows(
    robot: CoreRobot,
) -> None:
    robot.submit_task(straight())
    outputs = robot.onboard.handle(Readings((Reading("estop", True),), "pad"), seconds(0.12))

    assert outputs.signals == {"estop"}
    assert outputs.system_state
    assert [type(c).__name__ for c in outputs.commands] == ["Drive", "Drive", "Drive"]


def test_what_the_core_has_due_comes_before_the_control_step_of_the_same_instant(
    robot: CoreRobot,
) -> None:
    """A pose that became too old holds the task; a step after it would drive blindly."""
    robot.submit_task(straight())
    outputs = robot.onboard.handle(TimePassed(), robot.now + seconds(1))
    commands = [c.command.speed_mps for c in outputs.commands if isinstance(c, Drive)]
    pausing = next(event for event in outputs.events if event.kind == "task.pausing")

    assert pausing.at == robot.now + seconds(0.3) + 1
    assert commands[:6] == pytest.approx([0.1, 0.15, 0.2, 0.25, 0.3, 0.35])
    assert commands[6:] == [0.0]


def test_a_report_is_checked_before_it_is_taken(robot: CoreRobot) -> None:
    before = robot.core.driving.vehicle
    with pytest.raises(InvalidValueError, match="not finite"):
        robot.give(VehicleReport(VehicleState(Pose(0.0, 0.0, 0.0), math.inf, 0.0)))

    assert robot.core.driving.vehicle == before


def test_an_error_that_is_due_at_the_instant_of_a_control_step_comes_before_it(
    robot: CoreRobot,
) -> None:
    others = {name: value for name, value in GOOD.items() if name != "gps_accuracy"}
    for _ in range(149):
        robot.read(gps_accuracy=250.0, **others)
        robot.advance(0.1)
    robot.submit_task(straight())
    outputs = robot.onboard.handle(TimePassed(), robot.now + seconds(0.2))

    assert speeds(robot)[-1:] == [0.05]
    driven = [c.command.speed_mps for c in outputs.commands if isinstance(c, Drive)]
    assert driven == pytest.approx([0.1, 0.0])
    raised = next(event for event in outputs.events if event.kind == "error.raised")
    assert raised.at == seconds(15)


# --- an input that is late by our own fault ------------------------------------------------------


def at(robot: CoreRobot) -> VehicleReport:
    """Return a report of the vehicle where it is."""
    state = robot.core.driving.vehicle.state
    assert state is not None
    return VehicleReport(state)


def test_a_pose_that_is_late_by_our_own_fault_is_taken_before_its_age_is_judged(
    robot: CoreRobot,
) -> None:
    robot.submit_task(straight())
    robot.advance(1)
    late = robot.now + seconds(1)
    taken = robot.onboard.take_in(at(robot), late)
    outputs = robot.onboard.handle(TimePassed(), late)
    assert not {"hold.set", "task.pausing"} & {e.kind for e in (*taken.events, *outputs.events)}


def test_of_missed_control_steps_one_is_made_up_for_with_the_first_pose(
    robot: CoreRobot,
) -> None:
    robot.submit_task(straight())
    robot.advance(1)
    late = robot.now + seconds(0.71)
    first = robot.onboard.take_in(at(robot), late)
    second = robot.onboard.take_in(at(robot), late)
    assert [type(command).__name__ for command in first.commands] == ["Drive"]
    assert second.commands == ()


def test_without_a_pose_no_missed_control_step_is_made_up_for(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    robot.advance(1)
    late = robot.now + seconds(0.71)
    button = Readings((Reading("estop", False),), "pad")
    assert robot.onboard.take_in(button, late).commands == ()
    assert robot.onboard.take_in(at(robot), late).commands == ()
    outputs = robot.onboard.handle(TimePassed(), late + seconds(0.05))
    assert [type(command).__name__ for command in outputs.commands] == ["Drive"]


def test_a_task_that_is_submitted_while_the_service_is_late_is_driven_with_the_next_pose(
    robot: CoreRobot,
) -> None:
    late = robot.now + seconds(1)
    asked = robot.onboard.take_in(TaskRequest(straight(), 0, "stanley", 2.8), late)
    reported = robot.onboard.take_in(at(robot), late)
    driven = robot.onboard.handle(TimePassed(), late + seconds(0.1))

    ended = [event.kind for each in (asked, reported, driven) for event in each.events]
    assert "task.aborted" not in ended
    assert [type(command).__name__ for command in driven.commands][:1] == ["Drive"]


def test_what_was_due_is_judged_next_if_the_input_does_not_end_it(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    robot.advance(1)
    late = robot.now + seconds(1)
    assert not robot.onboard.take_in(Readings((Reading("estop", False),), "pad"), late).commands
    outputs = robot.onboard.handle(TimePassed(), late)
    assert "task.pausing" in {event.kind for event in outputs.events}


def test_of_signals_that_arrive_one_after_the_other_none_is_stale_in_between(
    robot: CoreRobot,
) -> None:
    late = robot.now + seconds(60)
    for name, value in GOOD.items():
        robot.onboard.take_in(Readings((Reading(name, value),), "pad"), late)
    robot.onboard.take_in(at(robot), late)
    robot.onboard.handle(TimePassed(), late)
    assert robot.core.system_state().errors == ()


def test_a_late_input_that_is_refused_changes_nothing_and_judges_nothing(robot: CoreRobot) -> None:
    late = robot.now + seconds(60)
    with pytest.raises(InvalidValueError):
        robot.onboard.take_in(Readings((Reading("battery_level", 7.0),), "pad"), late)
    assert robot.core.system_state().errors == ()
    robot.onboard.handle(TimePassed(), late)
    assert robot.core.system_state().errors == ("STALE_DATA",)


def test_what_a_controller_says_to_a_robot_that_has_none_is_left_aside(robot: CoreRobot) -> None:
    robot.submit_task(straight())
    outputs = robot.give(ControllerStatus(available=False, reason="gone"))

    assert (outputs.commands, outputs.events) == ((), ())
    assert robot.task.status is TaskPhase.RUNNING


def test_deadlines_of_the_core_come_before_what_a_controller_says() -> None:
    robot = ControlledRobot()
    robot.submit_task(straight())
    robot.drive(1)
    outputs = robot.onboard.handle(ControllerFeedback(GoalId(1), 1, 0.1), robot.now + seconds(0.4))
    told = [event for event in outputs.events if event.kind == "hold.set"]

    assert [event.data["owner"] for event in told] == ["vehicle"]
    assert told[0].at == robot.now + seconds(0.3) + 1


def test_devices_that_changed_are_told_with_what_was_due_before() -> None:
    parts = (Outputs(devices=frozenset({ComputerName("arm")})), Outputs(task_changed=True))
    robot = CoreRobot(SmhModel({}, {}))
    robot.onboard._untold += parts  # noqa: SLF001  # of calls whose input was rejected
    outputs = robot.onboard.handle(TimePassed(), robot.now)

    assert outputs.devices == {"arm"}
