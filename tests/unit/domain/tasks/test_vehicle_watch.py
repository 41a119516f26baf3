import math

import pytest

from domain.errors import InvalidValueError
from domain.findings import Blocker
from domain.inputs import VehicleReport
from domain.outbox import Outbox
from domain.snapshot import VehicleView
from domain.tasks.settings import TaskSettings
from domain.tasks.vehicle_watch import VehicleWatch
from domain.timebase import seconds
from domain.vehicle import DriveCommand, Point, Pose, VehicleState


@pytest.fixture
def watch() -> VehicleWatch:
    return VehicleWatch(TaskSettings(), Outbox())


def report(x_m: float = 0.0, speed_mps: float = 0.0, steering_rad: float = 0.0) -> VehicleReport:
    return VehicleReport(VehicleState(Pose(x_m, 0.0, 0.0), speed_mps, steering_rad))


def test_a_vehicle_that_never_reported_is_lost_and_has_no_place(watch: VehicleWatch) -> None:
    assert watch.is_lost
    assert not watch.stands
    assert watch.distance_to(Point(0.0, 0.0)) is None
    assert watch.wake_at() is None


def test_it_is_lost_right_after_its_pose_may_be_that_old(watch: VehicleWatch) -> None:
    watch.take(report(), seconds(1))
    assert watch.wake_at() == seconds(1.3) + 1
    assert not watch.pass_time(seconds(1.3))
    assert watch.pass_time(seconds(1.3) + 1)

    assert watch.is_lost
    assert not watch.pass_time(seconds(9)), "it is told once"


@pytest.mark.parametrize(("speed_mps", "stands"), [(0.049, True), (-0.049, True), (0.05, False)])
def test_below_5_cm_a_second_it_stands(watch: VehicleWatch, speed_mps: float, stands: bool) -> None:
    watch.take(report(speed_mps=speed_mps), 0)

    assert watch.stands is stands


def test_distances_count_from_its_last_place(watch: VehicleWatch) -> None:
    watch.take(report(x_m=1.0), 0)

    assert watch.distance_to(Point(4.0, 4.0)) == 5.0


def test_the_command_to_stop_keeps_the_wheels_as_they_were_reported(watch: VehicleWatch) -> None:
    assert watch.stop_command() == DriveCommand(0.0, 0.0)
    watch.take(report(steering_rad=-0.3), 0)

    assert watch.stop_command() == DriveCommand(0.0, -0.3)


def test_only_what_differs_is_a_change() -> None:
    outbox = Outbox()
    watch = VehicleWatch(TaskSettings(), outbox)
    watch.take(report(), 0)
    watch.told(DriveCommand(1.0, 0.0), Point(1.0, 0.0))
    outbox.take()
    watch.take(report(), seconds(0.05))
    watch.told(DriveCommand(1.0, 0.0), Point(1.0, 0.0))
    assert not outbox.take().vehicle_changed
    watch.told(DriveCommand(1.1, 0.0), Point(1.0, 0.0))

    assert outbox.take().vehicle_changed


def test_speed_is_only_what_was_reported_since_then_and_not_too_long_ago(
    watch: VehicleWatch,
) -> None:
    assert watch.speed_since(0) is None
    assert not watch.moves
    watch.take(report(speed_mps=-2.0), seconds(1))
    assert watch.moves
    assert watch.speed_since(seconds(1)) is None, "no report since"
    assert watch.speed_since(seconds(0.9)) == 2.0
    watch.pass_time(seconds(2))

    assert watch.speed_since(seconds(0.9)) is None


def test_that_it_does_not_stand_as_it_should_is_shown() -> None:
    outbox = Outbox()
    watch = VehicleWatch(TaskSettings(), outbox)
    blocker = Blocker("STILL_MOVING", "1.1 m/s", ("vehicle",))
    watch.found(blocker)

    assert watch.view.still_moving is blocker
    assert outbox.take().vehicle_changed


@pytest.mark.parametrize(
    "state",
    [
        VehicleState(Pose(math.nan, 0.0, 0.0), 0.0, 0.0),
        VehicleState(Pose(0.0, math.inf, 0.0), 0.0, 0.0),
        VehicleState(Pose(0.0, 0.0, -math.inf), 0.0, 0.0),
        VehicleState(Pose(0.0, 0.0, 0.0), math.nan, 0.0),
        VehicleState(Pose(0.0, 0.0, 0.0), 0.0, math.nan),
    ],
)
def test_no_number_of_a_report_may_be_infinite_or_none(
    watch: VehicleWatch, state: VehicleState
) -> None:
    with pytest.raises(InvalidValueError) as refused:
        watch.check(VehicleReport(state))

    assert refused.value.message == "the vehicle reports a number that is not finite"
    assert refused.value.pointer == "pose"


def test_a_report_of_finite_numbers_is_taken(watch: VehicleWatch) -> None:
    watch.check(report(x_m=-3.0, speed_mps=1.0, steering_rad=0.1))


def test_distances_are_signed_in_no_direction(watch: VehicleWatch) -> None:
    state = VehicleState(Pose(-2.0, 3.0, 0.0), 0.0, 0.0)
    watch.take(VehicleReport(state), 0)

    assert watch.distance_to(Point(1.0, -1.0)) == 5.0


def test_a_vehicle_that_is_lost_has_no_place_though_it_once_had_one(watch: VehicleWatch) -> None:
    watch.take(report(), 0)
    watch.pass_time(seconds(1))

    assert watch.distance_to(Point(0.0, 0.0)) is None
    assert not watch.stands


def test_before_anything_is_heard_or_told_it_is_seen_to_stand_nowhere(watch: VehicleWatch) -> None:
    assert watch.view == VehicleView(None, None, DriveCommand(0.0, 0.0), None)
