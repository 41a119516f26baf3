import math
from dataclasses import replace

import pytest

from domain.actor import SERVICE
from domain.computers import ComputerName
from domain.controller import NavigationStatus
from domain.devices.settings import LeadSettings
from domain.errors import InvalidValueError, ReservedHoldError, TooManyHoldsError
from domain.identifiers import TaskId
from domain.inputs import DriveStatus, HoldRequest, Restored, TimePassed, VehicleReport
from domain.kept import Kept, KeptHold, KeptProgress, KeptTask
from domain.outbox import Outputs
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


def test_a_device_has_no_vehicle_and_waits_for_no_pose() -> None:
    settings = SupervisionSettings(lead=LeadSettings(ComputerName("arm")))
    core = Supervision(SmhModel({}, {}), settings, 0)
    assert "vehicle" not in core.driving.holds

    core.handle(VehicleReport(VehicleState(Pose(0.0, 0.0, 0.0), 1.0, 0.0)), seconds(1))
    core.handle(TimePassed(), seconds(9))

    assert "vehicle" not in core.driving.holds
    assert core.driving.vehicle.state is None


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


@pytest.mark.parametrize("owner", ["error", "vehicle", "drive_process", "navigation"])
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


def test_a_task_is_held_while_its_controller_is_given_no_goals(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.give(NavigationStatus(available=False, reason="the controller is gone"))
    assert robot.core.driving.holds == {
        "navigation": HoldView("navigation", "the controller is gone", "", robot.now)
    }
    (held,) = (event for event in robot.events if event.kind == "hold.set")
    (told,) = (event for event in robot.events if event.kind == "navigation.unavailable")
    assert held.cause == told.id
    assert told.event.words == ("the external controller is given no goals: the controller is gone")

    robot.give(NavigationStatus(available=True))
    assert robot.task.status is TaskPhase.RUNNING
    assert robot.happened("hold.released") == [{"owner": "navigation"}]


def test_that_a_vehicle_can_be_commanded_is_no_news(robot: ScriptedRobot) -> None:
    assert robot.give(DriveStatus(available=True)).events == ()


def test_a_vehicle_that_rolls_on_without_commands_is_told(robot: ScriptedRobot) -> None:
    robot.submit_task()
    robot.advance(1.0, 2.0)
    robot.give(DriveStatus(available=False, reason="the drive process has ended"))
    robot.advance(5.0, 2.0)

    assert robot.core.system_state().reasons[0].code == "STILL_MOVING"


# --- over a restart ------------------------------------------------------------------------------


GATE = KeptHold("gate-3", "closed", "http:10.0.0.7", seconds(1))
LUNCH = KeptHold("operator", "lunch", "anna", seconds(2))


def restarted(*kept: Kept) -> ScriptedRobot:
    """Return a robot whose service was started anew, 100 s after the first start."""
    robot = ScriptedRobot(pose=False, good=False, start=seconds(100))
    robot.give(Restored(kept, boot=2))
    return robot


def test_a_hold_is_kept_until_it_is_released(robot: ScriptedRobot) -> None:
    robot.hold("gate-3", "closed")
    assert robot.all_kept() == (KeptHold("gate-3", "closed", "operator", 0),)
    robot.hold("gate-3", "still closed")
    assert robot.all_kept() == (KeptHold("gate-3", "still closed", "operator", 0),)

    robot.release("gate-3")
    assert robot.kept == {(KeptHold, "gate-3"): None}


def test_a_hold_set_twice_alike_is_written_once(robot: ScriptedRobot) -> None:
    robot.hold()

    assert robot.hold() == Outputs()
    assert robot.release("gate-3") == Outputs(), "nor is a release of what is not set"


def test_the_holds_of_pilothouse_follow_from_what_is_read_and_are_not_kept(
    robot: ScriptedRobot,
) -> None:
    robot.read(battery_level=0.42)
    robot.give(DriveStatus(available=False, reason="no process"))
    robot.stay_silent(1.0)

    assert set(robot.core.driving.holds) == {"error", "vehicle", "drive_process"}
    assert not [kept for kept in robot.all_kept() if isinstance(kept, KeptHold)]


def test_the_hold_with_which_the_service_ends_is_not_kept(robot: ScriptedRobot) -> None:
    robot.give(HoldRequest("service", "the service ends", SERVICE))

    assert "service" in robot.core.driving.holds
    assert robot.all_kept() == ()


def test_a_hold_of_that_name_which_a_person_set_is_kept_as_it_was_set(
    robot: ScriptedRobot,
) -> None:
    robot.hold("service", "inspection")
    robot.give(HoldRequest("service", "the service ends", SERVICE))

    assert robot.all_kept() == (KeptHold("service", "inspection", "operator", 0),)


def test_after_a_restart_the_holds_are_as_they_were_set() -> None:
    robot = restarted(LUNCH, GATE)
    holds = robot.core.driving.holds

    assert [holds[name] for name in ("gate-3", "operator")] == [
        HoldView("gate-3", "closed", "http:10.0.0.7", seconds(1)),
        HoldView("operator", "lunch", "anna", seconds(2)),
    ]
    assert list(holds)[-2:] == ["gate-3", "operator"], "the one set first is told first"
    assert "restart" not in holds
    assert robot.happened("hold.set") == [], "they were set before"
    assert robot.kept == {}, "they are kept already"
    robot.advance(0.5)
    robot.submit_task()
    assert robot.task.reason == "closed; lunch"


def test_a_hold_of_an_earlier_run_is_released_as_any_other() -> None:
    robot = restarted(GATE)
    robot.advance(0.5)
    robot.submit_task()
    robot.release("gate-3")

    assert robot.task.status is TaskPhase.RUNNING
    assert robot.kept[KeptHold, "gate-3"] is None


def test_a_hold_that_was_set_at_a_time_to_come_is_set_now() -> None:
    robot = restarted(replace(GATE, since=seconds(900)))

    assert robot.core.driving.holds["gate-3"].since == seconds(100)


def test_as_many_holds_as_there_may_be_come_back_beside_those_of_pilothouse() -> None:
    many = [replace(GATE, owner=f"owner{n:03}", since=n) for n in range(MAX_HOLDS + 2)]
    robot = restarted(*reversed(many))

    assert set(robot.core.driving.holds) == {
        "error",
        "vehicle",
        *(hold.owner for hold in many[:MAX_HOLDS]),
    }
    why = f"there are {MAX_HOLDS} holds already"
    assert robot.happened("service.not_restored") == [
        {"what": f"the hold {hold.owner}", "reason": why} for hold in many[MAX_HOLDS:]
    ]
    assert robot.kept == {(KeptHold, hold.owner): None for hold in many[MAX_HOLDS:]}


@pytest.mark.parametrize("owner", ["vehicle", "restart"])
def test_a_hold_whose_name_is_pilothouses_own_now_is_left_out(owner: str) -> None:
    robot = restarted(replace(GATE, owner=owner))

    assert [event["what"] for event in robot.happened("service.not_restored")] == [
        f"the hold {owner}"
    ]
    assert "restart" not in robot.core.driving.holds


def test_nobody_sets_the_hold_of_a_restart(robot: ScriptedRobot) -> None:
    with pytest.raises(ReservedHoldError):
        robot.hold("restart")
    assert robot.release("restart") == Outputs(), "as of any hold that is not set"


def test_a_task_that_makes_no_sense_is_left_out_and_told() -> None:
    task = KeptTask(TaskId("t3"), straight(), "stanley", 2.8, 99, created_at=0, cause=1)
    robot = restarted(task, KeptProgress(TaskId("t3"), True, 3, 2.0, 0.0))

    assert list(robot.core.driving.tasks()) == []
    assert robot.happened("service.not_restored") == [
        {"what": "the task t3", "reason": "its path has no such waypoint"}
    ]
    assert robot.kept == {(KeptTask, "t3"): None, (KeptProgress, "t3"): None}
