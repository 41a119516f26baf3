"""Goals as a client of the action sends them, with a simulated vehicle in virtual time."""

from math import inf, nan

import numpy as np
import pytest

from domain.commands import Drive
from domain.controller import GoalOutcome
from domain.errors import InvalidValueError
from domain.goal_server import (
    REPLACED,
    GoalEnded,
    GoalMessage,
    GoalProgress,
    GoalServer,
    WaypointGoal,
)
from domain.identifiers import GoalId
from domain.inputs import DriveStatus, VehicleReport
from domain.navigation import NavigationSettings
from domain.simulation.vehicle import SimulatedVehicle
from domain.simulation.vehicle_settings import Plant, VehicleSettings
from domain.tasks.settings import TaskSettings
from domain.timebase import Instant, seconds
from domain.vehicle import Pose, VehicleLimits, VehicleState

LIMITS = VehicleLimits()
STEP = seconds(0.01)
TRACKERS = ("pure_pursuit", "stanley")
BRAKES = Plant(acceleration_mps2=2.0, braking_mps2=2.0)


def line(length_m: float = 20.0, spacing_m: float = 1.0) -> np.ndarray:
    x = np.arange(0.0, length_m + spacing_m / 2, spacing_m)
    return np.column_stack((x, np.zeros_like(x), np.zeros_like(x)))


def goal(
    length_m: float = 20.0, start_index: int = 0, speed_mps: float = 2.8, spacing_m: float = 1.0
) -> WaypointGoal:
    return WaypointGoal.checked(line(length_m, spacing_m), start_index, speed_mps, LIMITS)


class Road:
    """A vehicle on a line, and the server that drives it."""

    def __init__(
        self, controller: str = "pure_pursuit", pose: Pose | None = None, plant: Plant = BRAKES
    ) -> None:
        self.now: Instant = 0
        settings = VehicleSettings(pose or Pose(0.0, 0.0, 0.0), plant, LIMITS)
        self.vehicle = SimulatedVehicle(settings, 0)
        self.server = GoalServer(
            LIMITS, TaskSettings(), NavigationSettings(), controller, seconds(1.0)
        )
        self.odometry = True
        self.told: list[GoalMessage] = []
        self.stay(0.1)

    def stay(self, by_s: float) -> None:
        """Let time pass."""
        until = self.now + seconds(by_s)
        while self.now < until:
            self.now += STEP
            for report in self.vehicle.advance(self.now):
                if self.odometry:
                    self.server.report(report, self.now)
            self.act()

    def act(self) -> None:
        for message in self.server.advance(self.now):
            self.told.append(message)
            if isinstance(message, Drive):
                self.vehicle.drive(message.command, self.now)

    def begin(self, asked: WaypointGoal) -> GoalId:
        begun = self.server.begin(asked, self.now)
        self.act()
        return begun

    def cancel(self, asked: GoalId) -> None:
        self.server.cancel(asked, self.now)
        self.act()

    @property
    def speed_mps(self) -> float:
        return self.vehicle.state.speed_mps

    @property
    def x_m(self) -> float:
        return self.vehicle.state.pose.x_m

    def ends(self) -> list[GoalEnded]:
        return [message for message in self.told if isinstance(message, GoalEnded)]

    def progress(self) -> list[GoalProgress]:
        return [message for message in self.told if isinstance(message, GoalProgress)]

    def last_command_mps(self) -> float:
        return [m.command.speed_mps for m in self.told if isinstance(m, Drive)][-1]


# --- a goal --------------------------------------------------------------------------------------


@pytest.mark.parametrize("controller", TRACKERS)
def test_a_goal_is_driven_to_its_end_and_succeeds_at_standstill(controller: str) -> None:
    road = Road(controller)

    begun = road.begin(goal())
    road.stay(20)

    assert road.ends() == [GoalEnded(begun, GoalOutcome.SUCCEEDED)]
    assert road.x_m == pytest.approx(20.0, abs=0.5)
    assert road.speed_mps == 0.0
    assert road.last_command_mps() == 0.0


def test_progress_is_the_share_of_the_path_and_never_falls() -> None:
    road = Road()

    road.begin(goal())
    road.stay(20)

    shares = [each.progress for each in road.progress()]
    indices = [each.target_index for each in road.progress()]
    assert shares == sorted(shares)
    assert indices == sorted(indices)
    assert shares[0] == pytest.approx(0.0, abs=0.05)
    assert shares[-1] == pytest.approx(1.0, abs=0.05)
    assert indices[-1] == 20


def test_feedback_comes_twenty_times_a_second() -> None:
    road = Road()

    road.begin(goal(100.0))
    road.stay(10)

    assert len(road.progress()) == pytest.approx(200, abs=2)


def test_nothing_is_commanded_once_the_vehicle_stands_after_a_goal() -> None:
    road = Road()
    road.begin(goal())
    road.stay(20)
    road.told.clear()

    road.stay(5)

    assert road.told == []
    assert road.server.wake_at() is None


def test_a_goal_that_begins_too_far_away_is_aborted_and_says_so() -> None:
    road = Road(pose=Pose(50.0, 50.0, 0.0))

    begun = road.begin(goal())

    [ended] = road.ends()
    assert (ended.goal, ended.end) == (begun, GoalOutcome.ABORTED)
    assert "5 m" in ended.message
    assert road.last_command_mps() == 0.0


# --- resumed -------------------------------------------------------------------------------------


@pytest.mark.parametrize("controller", TRACKERS)
@pytest.mark.parametrize("spacing_m", [1.0, 10.0, 20.0])
def test_a_goal_that_was_canceled_goes_on_from_its_target_index(
    controller: str, spacing_m: float
) -> None:
    road = Road(controller)
    first = road.begin(goal(40.0, spacing_m=spacing_m))
    road.stay(6)
    road.cancel(first)
    road.stay(4)
    stood_at_m, index = road.x_m, road.progress()[-1].target_index
    road.told.clear()

    second = road.begin(goal(40.0, start_index=index, spacing_m=spacing_m))
    road.stay(25)

    assert road.ends() == [GoalEnded(second, GoalOutcome.SUCCEEDED)]
    assert road.progress()[0].progress == pytest.approx(stood_at_m / 40.0, abs=0.03)
    assert min(each.target_index for each in road.progress()) == index
    assert road.x_m == pytest.approx(40.0, abs=0.5)


def test_a_goal_goes_on_from_its_last_waypoint() -> None:
    road = Road(pose=Pose(17.0, 0.0, 0.0))

    begun = road.begin(goal(20.0, start_index=20))
    road.stay(10)

    assert road.ends() == [GoalEnded(begun, GoalOutcome.SUCCEEDED)]
    assert road.x_m == pytest.approx(20.0, abs=0.5)


# --- canceled ------------------------------------------------------------------------------------


def test_a_cancel_commands_speed_0_at_once_and_ends_the_goal_at_standstill() -> None:
    road = Road()
    begun = road.begin(goal(100.0))
    road.stay(5)

    road.cancel(begun)

    assert road.last_command_mps() == 0.0
    assert road.speed_mps > 2.0
    assert road.ends() == []
    road.stay(3)
    assert road.ends() == [GoalEnded(begun, GoalOutcome.CANCELED, "canceled")]
    assert road.speed_mps == 0.0


def test_speed_0_is_repeated_until_the_vehicle_stands() -> None:
    road = Road(plant=Plant(braking_mps2=0.5, acceleration_mps2=2.0))
    begun = road.begin(goal(100.0))
    road.stay(5)
    road.told.clear()

    road.cancel(begun)
    road.stay(3)

    speeds = [m.command.speed_mps for m in road.told if isinstance(m, Drive)]
    assert len(speeds) > 50
    assert set(speeds) == {0.0}
    assert road.ends() == []


def test_a_vehicle_that_does_not_stop_aborts_a_canceled_goal() -> None:
    road = Road()
    begun = road.begin(goal(1000.0))
    road.stay(5)
    road.cancel(begun)

    moving = VehicleState(Pose(10.0, 0.0, 0.0), 2.0, 0.0)
    for _ in range(500):
        road.now += seconds(0.05)
        road.server.report(VehicleReport(moving), road.now)
        road.act()

    assert road.ends() == [GoalEnded(begun, GoalOutcome.ABORTED, "the vehicle does not stop")]
    assert road.last_command_mps() == 0.0


def test_a_cancel_of_a_goal_that_has_ended_does_nothing() -> None:
    road = Road()
    old = road.begin(goal(100.0))
    new = road.begin(goal(100.0))
    road.stay(1)

    road.cancel(old)
    road.stay(1)

    assert road.server.goal == new
    assert road.last_command_mps() > 0.0


# --- replaced ------------------------------------------------------------------------------------


def test_a_newer_goal_replaces_the_one_before_without_a_stop() -> None:
    road = Road()
    old = road.begin(goal(100.0))
    road.stay(5)
    index = road.progress()[-1].target_index
    road.told.clear()

    road.begin(goal(100.0, start_index=index))
    road.stay(2)

    assert road.ends() == [GoalEnded(old, GoalOutcome.ABORTED, REPLACED)]
    speeds = [m.command.speed_mps for m in road.told if isinstance(m, Drive)]
    assert min(speeds) > 2.0


def test_a_goal_that_is_being_canceled_ends_as_canceled_when_it_is_replaced() -> None:
    road = Road()
    old = road.begin(goal(100.0))
    road.stay(5)
    road.cancel(old)

    new = road.begin(goal(100.0, start_index=road.progress()[-1].target_index))
    road.stay(5)

    assert road.ends() == [GoalEnded(old, GoalOutcome.CANCELED, REPLACED)]
    assert road.server.goal == new
    assert road.speed_mps > 2.0


# --- what goes wrong -----------------------------------------------------------------------------


def test_without_odometry_a_goal_is_aborted_and_nothing_but_speed_0_is_commanded() -> None:
    road = Road()
    road.odometry = False
    road.stay(1)

    begun = road.begin(goal())
    road.stay(5)

    ended = GoalEnded(begun, GoalOutcome.ABORTED, "no pose of the vehicle for 0.3 s")
    assert road.ends() == [ended]
    assert {m.command.speed_mps for m in road.told if isinstance(m, Drive)} == {0.0}
    assert road.server.wake_at() is None


def test_odometry_that_falls_silent_stops_the_vehicle_before_that_is_told() -> None:
    road = Road()
    begun = road.begin(goal(100.0))
    road.stay(5)

    road.odometry = False
    road.stay(0.5)

    [ended] = road.ends()
    assert (ended.goal, ended.end) == (begun, GoalOutcome.ABORTED)
    before = road.told[road.told.index(ended) - 1]
    assert isinstance(before, Drive)
    assert before.command.speed_mps == 0.0


def test_odometry_that_falls_silent_during_a_cancel_is_told() -> None:
    road = Road()
    begun = road.begin(goal(100.0))
    road.stay(5)
    road.cancel(begun)

    road.odometry = False
    road.stay(0.5)

    assert road.ends() == [GoalEnded(begun, GoalOutcome.ABORTED, "there is no pose of the vehicle")]


def test_a_supervisor_that_falls_silent_stops_the_vehicle_since_nobody_else_would() -> None:
    road = Road()
    road.server.hear_supervisor(road.now)
    begun = road.begin(goal(100.0))
    road.stay(0.9)
    road.server.hear_supervisor(road.now)
    road.stay(0.9)
    assert road.ends() == []
    assert road.speed_mps > 0.5

    road.stay(0.3)

    why = "no word of the supervisor for 1 s"
    assert road.ends() == [GoalEnded(begun, GoalOutcome.ABORTED, why)]
    road.stay(3)
    assert road.speed_mps == 0.0


def test_a_supervisor_that_is_gone_before_a_goal_is_not_missed() -> None:
    road = Road()
    road.server.hear_supervisor(road.now)
    road.stay(5)

    begun = road.begin(goal())
    road.stay(15)

    assert road.ends() == [GoalEnded(begun, GoalOutcome.SUCCEEDED)]


def test_a_goal_that_is_being_canceled_ends_as_canceled_without_a_supervisor() -> None:
    road = Road()
    road.server.hear_supervisor(road.now)
    begun = road.begin(goal(100.0))
    road.stay(0.9)

    road.cancel(begun)
    road.stay(3)

    assert [ended.end for ended in road.ends()] == [GoalOutcome.CANCELED]


def test_a_goal_is_aborted_when_commands_do_not_arrive() -> None:
    road = Road()
    begun = road.begin(goal(100.0))
    road.stay(2)

    road.server.note_drive(DriveStatus(available=False, reason="the process ended"), road.now)
    road.act()
    again = road.begin(goal(100.0))

    why = "commands do not arrive: the process ended"
    assert road.ends() == [
        GoalEnded(begun, GoalOutcome.ABORTED, why),
        GoalEnded(again, GoalOutcome.ABORTED, why),
    ]


def test_a_goal_is_driven_once_commands_arrive_again() -> None:
    road = Road()
    road.server.note_drive(DriveStatus(available=False, reason="the process ended"), road.now)
    road.server.note_drive(DriveStatus(available=True), road.now)

    road.begin(goal(100.0))
    road.stay(2)

    assert road.speed_mps > 1.0


def test_an_abort_stops_the_vehicle_before_it_is_told() -> None:
    road = Road()
    begun = road.begin(goal(100.0))
    road.stay(5)
    road.told.clear()

    road.server.abort("the end", road.now)
    road.act()

    drive, ended, *_ = road.told
    assert isinstance(drive, Drive)
    assert drive.command.speed_mps == 0.0
    assert ended == GoalEnded(begun, GoalOutcome.ABORTED, "the end")


def test_an_abort_without_a_goal_does_nothing() -> None:
    road = Road()
    road.told.clear()

    road.server.abort("the end", road.now)
    road.act()

    assert road.told == []


def test_a_report_that_is_no_number_is_rejected_and_changes_nothing() -> None:
    road = Road()
    road.begin(goal(100.0))

    with pytest.raises(InvalidValueError):
        road.server.report(VehicleReport(VehicleState(Pose(nan, 0.0, 0.0), 0.0, 0.0)), road.now)

    road.stay(1)
    assert road.ends() == []


# --- what is no goal -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("waypoints", "start_index", "speed_mps", "words"),
    [
        (line()[:1], 0, 2.8, "2 to 100000 waypoints"),
        (np.zeros((3, 3)), 0, 2.8, "position"),
        (np.full((3, 3), inf), 0, 2.8, "finite"),
        (line(), 21, 2.8, "start_index 21 is not within 0 to 20"),
        (line(), -1, 2.8, "start_index -1"),
        (line(), 0, 0.0, "speed 0 m/s"),
        (line(), 0, nan, "speed nan m/s"),
        (line(), 0, 12.0, "11.2 m/s"),
    ],
)
def test_what_cannot_be_driven_is_no_goal(
    waypoints: np.ndarray, start_index: int, speed_mps: float, words: str
) -> None:
    with pytest.raises(InvalidValueError, match=words):
        WaypointGoal.checked(waypoints, start_index, speed_mps, LIMITS)
