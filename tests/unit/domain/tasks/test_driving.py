import math

import pytest

from domain.errors import InvalidValueError, ReservedHoldError, TooManyHoldsError
from domain.inputs import DriveStatus, VehicleReport
from domain.parts.system_model import SmhModel
from domain.snapshot import HoldView, TaskPhase
from domain.supervision import Supervision, SupervisionSettings
from domain.tasks.holds import MAX_HOLDS
from domain.timebase import seconds
from domain.vehicle import Pose, VehicleLimits, VehicleState
from tests.support.paths import straight
from tests.support.scripted_robot import ScriptedRobot


def test_a_robot_that_does_not_know_where_it_is_is_held() -> None:
    robot = ScriptedRobot(pose=False)

    assert robot.core.driving.holds["vehicle"].reason == "the vehicle never reported a pose"


def test_the_first_pose_lets_go() -> None:
    robot = ScriptedRobot(pose=False)
    robot.report()

    assert dict(robot.core.driving.holds) == {}
    assert robot.happened("hold.released") == [{"owner": "vehicle"}]


def test_errors_at_the_start_hold_without_an_event() -> None:
    robot = ScriptedRobot(pose=False, good=False)

    assert "error" in robot.core.driving.holds
    assert robot.happened("hold.set") == []


def test_a_pose_that_is_exactly_as_old_as_it_may_be_holds_nothing(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.stay_silent(0.3)

    assert robot.task.status is TaskPhase.RUNNING


def test_a_pose_older_than_that_stops_and_holds_the_task(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.stay_silent(0.300_000_001)

    assert robot.task.status is TaskPhase.PAUSING
    assert robot.task.reason == "no pose of the vehicle for 0.3 s"
    assert robot.stops == 1


def test_the_task_goes_on_with_the_next_pose(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.stay_silent(1.0)
    robot.report()

    assert robot.task.status is TaskPhase.RUNNING
    assert len(robot.goals) == 2


def test_a_vehicle_that_is_lost_is_not_known_to_stand(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.stay_silent(1.0)

    assert not robot.core.driving.watch.stands
    assert robot.task.status is TaskPhase.PAUSING


@pytest.mark.parametrize("owner", ["error", "vehicle", "drive_process"])
def test_nobody_else_sets_or_clears_the_holds_of_pilothouse(
    robot: ScriptedRobot, owner: str
) -> None:
    with pytest.raises(ReservedHoldError):
        robot.hold(owner)
    with pytest.raises(ReservedHoldError):
        robot.release(owner)


def test_there_is_a_bound_on_holds(robot: ScriptedRobot) -> None:
    for number in range(MAX_HOLDS):
        robot.hold(f"owner{number}")
    with pytest.raises(TooManyHoldsError):
        robot.hold("one_more")
    robot.hold("owner0", "renewed")

    assert robot.core.driving.holds["owner0"].reason == "renewed"


def test_a_report_that_is_no_place_is_refused_and_the_last_one_stays(robot: ScriptedRobot) -> None:
    nowhere = VehicleState(Pose(math.nan, 0.0, 0.0), 0.0, 0.0)
    with pytest.raises(InvalidValueError, match="not finite"):
        robot.give(VehicleReport(nowhere))
    state = robot.core.driving.vehicle.state

    assert state is not None
    assert state.pose == Pose(0.0, 0.0, 0.0)


def test_the_hold_of_an_error_says_what_the_operator_needs_to_know(robot: ScriptedRobot) -> None:
    robot.read(battery_level=0.42)

    assert robot.core.driving.holds["error"].reason == "battery 42 % is below 50 %"


def test_the_reason_follows_the_errors_while_the_hold_stays(robot: ScriptedRobot) -> None:
    robot.read(battery_level=0.42)
    robot.read(temperature=60.0)

    assert robot.core.driving.holds["error"].reason.startswith("battery 42 % is below 50 %; ")


def test_a_stop_without_a_task_commands_standstill_all_the_same(robot: ScriptedRobot) -> None:
    robot.read(estop=True)

    assert robot.stops == 1


def test_what_the_vehicle_was_told_can_be_seen(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.feedback(3)
    view = robot.core.driving.vehicle

    assert view.command.speed_mps == 2.8
    assert view.lookahead is not None
    robot.hold()

    assert robot.core.driving.vehicle.command.speed_mps == 0.0
    assert robot.core.driving.vehicle.lookahead is None


def test_a_vehicle_that_stands_and_says_so_again_is_no_news(robot: ScriptedRobot) -> None:
    still = VehicleReport(VehicleState(Pose(0.0, 0.0, 0.0), 0.0, 0.0))
    moved = VehicleReport(VehicleState(Pose(0.1, 0.0, 0.0), 1.0, 0.0))

    assert not robot.give(still).vehicle_changed
    assert robot.give(moved).vehicle_changed


def test_of_many_errors_three_are_told_and_the_rest_counted() -> None:
    robot = ScriptedRobot(pose=False, good=False)
    told, _, rest = robot.core.driving.holds["error"].reason.rpartition("; ")

    assert len(told.split("; ")) == 3
    assert rest == "and 2 more"


def test_the_hold_of_an_error_ends_with_the_error(robot: ScriptedRobot) -> None:
    robot.read(estop=True)
    robot.advance(0.5)

    assert dict(robot.core.driving.holds) == {}
    assert robot.happened("hold.released") == [{"owner": "error"}]


def test_a_task_ends_as_navigation_says_and_can_be_read_with_its_path(robot: ScriptedRobot) -> None:
    path = straight()
    robot.submit_task(path)
    assert robot.core.driving.current_task == robot.task
    robot.arrive()

    assert robot.core.driving.current_task is None
    assert robot.core.driving.task("t1").status is TaskPhase.SUCCEEDED
    assert robot.core.driving.path_of("t1") is path


def test_a_task_is_canceled_on_request(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.cancel_task()

    assert robot.task.status is TaskPhase.CANCELED


def test_a_hold_of_an_operator_lasts_until_it_is_released(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.hold("operator", "lunch")
    assert (robot.task.status, robot.task.reason) == (TaskPhase.PAUSING, "lunch")
    robot.release("operator")

    assert robot.task.status is TaskPhase.RUNNING


def test_the_hold_of_a_lost_vehicle_is_that_of_nobody_and_begins_when_it_was_lost(
    robot: ScriptedRobot,
) -> None:
    robot.stay_silent(1.0)

    assert robot.core.driving.holds["vehicle"] == HoldView(
        "vehicle", "no pose of the vehicle for 0.3 s", "", seconds(0.3) + 1
    )


def test_how_a_robot_is_at_the_start_holds_it_from_then_on_and_is_nobodys_doing() -> None:
    robot = Supervision(SmhModel({}, {}), SupervisionSettings(), seconds(7))

    assert robot.driving.holds["vehicle"] == HoldView(
        "vehicle", "the vehicle never reported a pose", "", seconds(7)
    )
    error = robot.driving.holds["error"]
    assert (error.by, error.since) == ("", seconds(7))
    assert robot.driving.limits == VehicleLimits()


def test_a_hold_says_who_set_it_and_when(robot: ScriptedRobot) -> None:
    robot.stay_silent(0.1)
    robot.hold("gate", "closed")

    assert robot.core.driving.holds["gate"] == HoldView("gate", "closed", "operator", seconds(0.1))


def test_the_hold_of_an_error_is_nobodys_doing_and_begins_with_it(robot: ScriptedRobot) -> None:
    robot.stay_silent(0.1)
    robot.read(estop=True)

    hold = robot.core.driving.holds["error"]
    assert (hold.by, hold.since) == ("", seconds(0.1))


def test_what_ended_an_error_is_why_its_hold_goes(robot: ScriptedRobot) -> None:
    robot.read(estop=True)
    robot.advance(0.5)
    by_id = {event.id: event.kind for event in robot.events}
    (released,) = (event for event in robot.events if event.kind == "hold.released")

    assert released.cause is not None
    assert by_id[released.cause] == "error.cleared"


def test_a_vehicle_that_cannot_be_commanded_is_held_with_words_of_its_own(
    robot: ScriptedRobot,
) -> None:
    robot.submit_task()
    robot.advance(1.0, 2.0)
    robot.give(DriveStatus(available=False, reason="the drive process has ended"))

    assert robot.core.driving.holds == {
        "drive_process": HoldView("drive_process", "the drive process has ended", "", robot.now)
    }
    assert robot.task.status is TaskPhase.PAUSING
    assert robot.task.reason == "the drive process has ended"
    (held,) = (event for event in robot.events if event.kind == "hold.set")
    (told,) = (event for event in robot.events if event.kind == "drive.unavailable")
    assert held.cause == told.id
    assert told.event.words == (
        "drive commands do not reach the vehicle: the drive process has ended"
    )


def test_it_is_driven_on_once_it_can_be_commanded_again(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.give(DriveStatus(available=False, reason="the drive process has ended"))
    robot.give(DriveStatus(available=True))

    assert robot.task.status is TaskPhase.RUNNING
    assert robot.happened("hold.released") == [{"owner": "drive_process"}]


def test_that_a_vehicle_can_be_commanded_is_no_news(robot: ScriptedRobot) -> None:
    assert robot.give(DriveStatus(available=True)).events == ()


def test_a_vehicle_that_rolls_on_without_commands_is_told(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.advance(1.0, 2.0)
    robot.give(DriveStatus(available=False, reason="the drive process has ended"))
    robot.advance(5.0, 2.0)

    assert robot.core.system_state().reasons[0].code == "STILL_MOVING"
