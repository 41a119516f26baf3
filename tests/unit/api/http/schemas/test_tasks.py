from api.http.schemas.tasks import HoldJson, TaskJson, VehicleJson
from domain.findings import Blocker
from domain.identifiers import TaskId
from domain.snapshot import HoldView, TaskPhase, TaskView, VehicleView
from domain.timebase import seconds
from domain.vehicle import DriveCommand, Point, Pose, VehicleLimits, VehicleState
from tests.support.manual_clock import ManualClock

CLOCK = ManualClock()


def test_numbers_are_shown_without_the_noise_of_their_last_bits() -> None:
    state = VehicleState(Pose(0.1 + 0.2, -1e-9, 1 / 3), 2.7999999999999994, 0.0)
    view = VehicleView(state, seconds(1), DriveCommand(2.7999999999999994, 0.0), Point(1 / 3, 0))
    shown = VehicleJson.of(view, VehicleLimits(), CLOCK)

    assert shown.pose is not None
    assert shown.lookahead is not None
    assert (shown.pose.x_m, shown.pose.y_m, shown.pose.yaw_rad) == (0.3, 0.0, 0.333333)
    assert (shown.speed_mps, shown.command.speed_mps, shown.lookahead.x_m) == (2.8, 2.8, 0.333333)


def test_a_vehicle_that_never_reported_has_no_pose_and_no_speed() -> None:
    view = VehicleView(None, None, DriveCommand(0.0, 0.0), None)
    shown = VehicleJson.of(view, VehicleLimits(), CLOCK)

    assert (shown.pose, shown.speed_mps, shown.steering_angle_rad, shown.at) == (None,) * 4


def test_a_vehicle_that_should_stand_says_why_it_is_told() -> None:
    found = Blocker("STILL_MOVING", "it moved", ("vehicle",), 1.1, 0.05, seconds(1), refuses=False)
    view = VehicleView(None, None, DriveCommand(0.0, 0.0), None, found)
    shown = VehicleJson.of(view, VehicleLimits(), CLOCK).model_dump()["still_moving"]

    assert (shown["code"], shown["value"], shown["threshold"]) == ("STILL_MOVING", 1.1, 0.05)
    assert (shown["path"], shown["refuses"]) == (("vehicle",), False)
    assert shown["since_at"] == "2026-01-01T00:00:01.000Z"


def test_a_task_is_shown_with_its_times_and_reason() -> None:
    view = TaskView(
        TaskId("t1"), TaskPhase.ABORTED, "stanley", 2.8, 11, 10.0, 0, 6, 0.5, 5.0, None,
        "no progress for 20 s", seconds(1), seconds(2), 7,
    )  # fmt: skip
    shown = TaskJson.of(view, CLOCK)

    assert (shown.status, shown.reason) == ("ABORTED", "no progress for 20 s")
    assert (shown.created_at, shown.ended_at) == (
        "2026-01-01T00:00:01.000Z",
        "2026-01-01T00:00:02.000Z",
    )


def test_a_hold_of_pilothouse_itself_is_by_nobody() -> None:
    shown = HoldJson.of(HoldView("error", "estop is pressed", "", seconds(3)), CLOCK)

    assert (shown.owner, shown.by, shown.since_at) == ("error", "", "2026-01-01T00:00:03.000Z")
