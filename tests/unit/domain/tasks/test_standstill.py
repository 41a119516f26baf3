"""A vehicle that should stand: told when it does not, and silent when it does."""

from collections.abc import Callable

import pytest

from domain.inputs import Reading, Readings, Restored
from domain.parts.system_model import SmhModel
from domain.simulation.vehicle_settings import Noise, Plant, VehicleSettings
from domain.snapshot import TaskPhase
from domain.supervision import SupervisionSettings
from domain.tasks.settings import TaskSettings
from domain.timebase import seconds
from service.files.robot_settings import SignalsBlock
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.paths import straight
from tests.support.scripted_robot import ScriptedRobot

TOLD = ("vehicle.still_moving", "vehicle.standstill_unknown", "vehicle.stopped")


def told(robot: ScriptedRobot | CoreRobot) -> list[str]:
    """Return what was told of standing and moving, in order."""
    return [event.kind for event in robot.events if event.kind in TOLD]


def reason(robot: ScriptedRobot | CoreRobot) -> str | None:
    """Return the code of the first reason of the system state."""
    return next((each.code for each in robot.core.system_state().reasons), None)


def driving(speed_mps: float = 2.0, **settings: float) -> ScriptedRobot:
    """Return a robot whose task is driven at that speed."""
    tasks = TaskSettings(**settings)  # type: ignore[arg-type]
    robot = ScriptedRobot(settings=SupervisionSettings(tasks=tasks))
    robot.submit_task()
    robot.advance(1.0, speed_mps)
    return robot


def soft_brakes(braking_mps2: float = 0.05) -> CoreRobot:
    """Return a simulated robot that drives at 2.8 m/s, with brakes that nobody told."""
    robot = CoreRobot(
        SmhModel({}, {}),
        SupervisionSettings(SignalsBlock(stale_after_s=0.0).to_domain()),
        vehicle=VehicleSettings(plant=Plant(braking_mps2=braking_mps2)),
    )
    robot.read(**GOOD)
    robot.submit_task(straight(300))
    robot.advance(5.0)
    return robot


# --- what is asked to stand ----------------------------------------------------------------------

STOPS: dict[str, Callable[[ScriptedRobot], object]] = {
    "ESTOP": lambda robot: robot.give(Readings((Reading("estop", True),), "button")),
    "the emergency stop": lambda robot: robot.stop(),
    "a hold": lambda robot: robot.hold(),
    "a cancel": lambda robot: robot.cancel_task(),
    "a task that succeeded": lambda robot: robot.arrive(),
    "a task that was aborted": lambda robot: robot.arrive(succeeded=False, reason="lost"),
}


@pytest.mark.parametrize("stop", STOPS.values(), ids=STOPS.keys())
def test_after_any_stop_a_vehicle_that_rolls_on_is_told_once(
    stop: Callable[[ScriptedRobot], object],
) -> None:
    robot = driving(2.0)
    stop(robot)

    robot.advance(3.45, 1.9)
    assert told(robot) == []
    robot.advance(20.0, 1.9)
    assert told(robot) == ["vehicle.still_moving"]
    assert reason(robot) == "STILL_MOVING"


@pytest.mark.parametrize("stop", STOPS.values(), ids=STOPS.keys())
def test_after_any_stop_a_vehicle_that_stands_in_time_is_no_news(
    stop: Callable[[ScriptedRobot], object],
) -> None:
    robot = driving(2.0)
    stop(robot)
    robot.advance(3.4, 1.0)
    robot.advance(20.0, 0.0)

    assert told(robot) == []
    assert reason(robot) != "STILL_MOVING"


def test_any_error_is_such_a_stop() -> None:
    robot = driving(2.0)
    for _ in range(80):
        robot.now += seconds(0.05)
        robot.read(battery_level=0.1)
        robot.report(1.9)

    assert told(robot) == ["vehicle.still_moving"]


def test_a_stop_that_does_not_stop_is_told_with_speed_and_time() -> None:
    robot = soft_brakes()
    robot.stop("a child")
    robot.advance(34.0)

    assert robot.happened("vehicle.still_moving") == [{"speed_mps": 2.577, "after_s": 4.5}]
    engaged = next(e for e in robot.events if e.kind == "emergency_stop.engaged")
    moving = next(e for e in robot.events if e.kind == "vehicle.still_moving")
    assert moving.cause == engaged.id
    assert moving.event.notable
    assert robot.core.emergency_stop().standstill_at is None


def test_the_reason_says_what_was_measured_and_is_the_first_one() -> None:
    robot = soft_brakes()
    began = robot.now
    robot.stop("a child")
    robot.advance(10.0)
    state = robot.core.system_state()
    found = state.reasons[0]

    assert [each.code for each in state.reasons] == ["STILL_MOVING", "ESTOP"]
    assert state.errors == ("ESTOP",)
    assert state.error_code == 2
    assert (found.value, found.threshold, found.since, found.path) == (
        2.577,
        0.05,
        began,
        ("vehicle",),
    )
    assert found.message.startswith("the vehicle should stand, but moved at 2.58 m/s, 4.5 s after")
    assert not found.refuses
    assert robot.core.driving.vehicle.still_moving is found


def test_when_it_stands_at_last_that_is_told_and_the_reason_goes() -> None:
    robot = soft_brakes()
    robot.stop("a child")
    robot.advance(60.0)

    assert told(robot) == ["vehicle.still_moving", "vehicle.stopped"]
    assert 54 < robot.happened("vehicle.stopped")[0]["after_s"] < 56
    assert reason(robot) == "ESTOP"
    assert robot.core.driving.vehicle.still_moving is None
    assert robot.core.emergency_stop().standstill_at is not None


def test_brakes_that_fail_half_way_are_told() -> None:
    robot = driving(2.0)
    robot.stop()
    robot.advance(0.5, 1.5)
    robot.advance(0.5, 1.0)
    robot.advance(2.5, 0.8)

    assert robot.happened("vehicle.still_moving") == [{"speed_mps": 0.8, "after_s": 3.5}]


def test_brakes_as_good_as_promised_are_not_told() -> None:
    robot = soft_brakes(braking_mps2=1.0)
    robot.stop()
    robot.advance(20.0)

    assert told(robot) == []


def test_softer_brakes_that_were_declared_get_their_time() -> None:
    robot = driving(2.0, braking_mps2=0.5)
    robot.stop()
    robot.advance(5.95, 1.0)
    assert told(robot) == []
    robot.advance(0.05, 1.0)

    assert told(robot) == ["vehicle.still_moving"]


def test_backwards_counts_as_moving() -> None:
    robot = driving(2.0)
    robot.stop()
    robot.advance(4.0, -0.5)

    assert robot.happened("vehicle.still_moving")[0]["speed_mps"] == 0.5


@pytest.mark.parametrize(("speed_mps", "is_told"), [(0.049, False), (0.05, True)])
def test_below_5_cm_a_second_it_stands(speed_mps: float, is_told: bool) -> None:
    robot = driving(2.0)
    robot.stop()
    robot.advance(5.0, speed_mps)

    assert bool(told(robot)) is is_told


def test_any_speed_and_any_brakes_give_a_time_that_comes() -> None:
    robot = driving(1e308, braking_mps2=1e-300)
    robot.stop()
    robot.advance(600.95, 1e308)
    assert told(robot) == []
    robot.advance(0.05, 1e308)

    assert told(robot) == ["vehicle.still_moving"]


# --- one that stood, and moves again -------------------------------------------------------------


def test_a_vehicle_that_is_pushed_under_the_stop_is_told() -> None:
    robot = driving(2.0)
    robot.stop()
    robot.advance(10.0, 0.0)
    stood_at = robot.core.emergency_stop().standstill_at
    robot.advance(1.25, 0.2)
    assert told(robot) == []
    assert stood_at is not None
    robot.advance(0.05, 0.2)

    assert robot.happened("vehicle.still_moving") == [{"speed_mps": 0.2, "after_s": 1.25}]
    assert robot.core.emergency_stop().standstill_at is None, "it does not stand"
    robot.advance(0.05, 0.0)
    assert told(robot) == ["vehicle.still_moving", "vehicle.stopped"]
    assert robot.core.emergency_stop().standstill_at == robot.now


def test_a_paused_task_whose_vehicle_rolls_off_is_told() -> None:
    robot = driving(2.0)
    robot.hold()
    robot.advance(10.0, 0.0)
    robot.advance(5.0, 0.5)

    assert told(robot) == ["vehicle.still_moving"]


def test_a_nudge_that_ends_at_once_is_no_news() -> None:
    robot = driving(2.0)
    robot.stop()
    robot.advance(10.0, 0.0)
    for _ in range(20):
        robot.advance(0.3, 0.2)
        robot.advance(0.05, 0.0)

    assert told(robot) == []


def test_the_noise_of_a_vehicle_that_stands_is_no_movement() -> None:
    robot = CoreRobot(
        SmhModel({}, {}),
        SupervisionSettings(SignalsBlock(stale_after_s=0.0).to_domain()),
        vehicle=VehicleSettings(plant=Plant(braking_mps2=1.0, noise=Noise(speed_mps=0.3))),
    )
    robot.read(**GOOD)
    robot.submit_task(straight(300))
    robot.advance(5.0)
    robot.stop()
    robot.advance(600.0)

    assert told(robot) == []


def test_one_report_of_a_standstill_does_not_end_the_stop_of_a_vehicle_that_rolls_on() -> None:
    robot = driving(2.0)
    robot.cancel_task()
    robot.advance(1.0, 1.9)
    robot.advance(0.05, 0.0)
    robot.advance(5.0, 1.9)

    assert told(robot) == ["vehicle.still_moving"]


def test_a_vehicle_that_rolls_to_and_fro_stood_in_between() -> None:
    robot = driving(2.0)
    robot.stop()
    for _ in range(20):
        robot.advance(0.5, 0.4)
        robot.advance(0.5, -0.4)
    assert told(robot) == []
    robot.advance(2.0, -0.4)

    assert told(robot) == ["vehicle.still_moving"]


def test_without_a_task_something_else_may_drive_a_vehicle_that_stood() -> None:
    robot = driving(2.0)
    robot.cancel_task()
    robot.advance(5.0, 0.0)
    robot.advance(30.0, 1.0)

    assert told(robot) == []


def test_but_an_emergency_stop_stops_that_too() -> None:
    robot = ScriptedRobot()
    robot.advance(1.0, 1.0)
    robot.stop()
    robot.advance(5.0, 1.0)

    assert told(robot) == ["vehicle.still_moving"]


def test_and_so_does_a_hold() -> None:
    robot = ScriptedRobot()
    robot.advance(1.0, 1.0)
    robot.hold()
    robot.advance(5.0, 1.0)

    assert told(robot) == ["vehicle.still_moving"]


def test_a_task_canceled_before_the_vehicle_reported_that_it_moves_is_watched_all_the_same() -> (
    None
):
    robot = ScriptedRobot()
    robot.submit_task()
    robot.cancel_task()
    robot.advance(0.3, 0.0)
    robot.advance(5.0, 0.4)

    assert told(robot) == ["vehicle.still_moving"]


def test_a_robot_that_rolls_while_it_is_in_error_from_the_start_is_told() -> None:
    robot = ScriptedRobot(pose=False, good=False)
    for _ in range(60):
        robot.now += seconds(0.05)
        robot.report(0.5)

    assert told(robot) == ["vehicle.still_moving"]


# --- without a pose ------------------------------------------------------------------------------


def test_a_pose_that_goes_missing_while_it_stops_is_told() -> None:
    robot = driving(2.0)
    robot.stop()
    robot.advance(0.5, 1.5)
    robot.stay_silent(2.9)
    assert told(robot) == []
    robot.stay_silent(0.2)

    assert robot.happened("vehicle.standstill_unknown") == [{"after_s": 3.5}]
    found = robot.core.system_state().reasons[0]
    assert (found.code, found.value) == ("STANDSTILL_UNKNOWN", None)
    assert "no pose to show it" in found.message


def test_a_pose_that_goes_missing_is_a_stop_of_its_own() -> None:
    robot = driving(2.0)
    robot.stay_silent(10.0)

    assert told(robot) == ["vehicle.standstill_unknown"]


def test_a_pose_that_comes_back_says_whether_it_stands() -> None:
    robot = driving(2.0)
    robot.stop()
    robot.stay_silent(10.0)
    robot.advance(0.1, 1.5)
    assert reason(robot) == "STILL_MOVING"
    robot.stay_silent(1.0)
    assert reason(robot) == "STANDSTILL_UNKNOWN"
    robot.advance(0.1, 0.0)

    assert told(robot) == [
        "vehicle.standstill_unknown",
        "vehicle.still_moving",
        "vehicle.standstill_unknown",
        "vehicle.stopped",
    ]


def test_a_vehicle_that_stood_and_then_is_not_heard_is_no_alarm() -> None:
    robot = driving(2.0)
    robot.stop()
    robot.advance(5.0, 0.0)
    robot.stay_silent(60.0)

    assert told(robot) == []


def test_a_robot_that_never_had_a_pose_is_no_alarm() -> None:
    robot = ScriptedRobot(pose=False)
    robot.stop()
    robot.stay_silent(60.0)

    assert told(robot) == []


def test_a_pose_from_before_the_stop_does_not_show_a_standstill() -> None:
    robot = ScriptedRobot(
        settings=SupervisionSettings(tasks=TaskSettings(pose_stale_after=seconds(60)))
    )
    robot.submit_task()
    robot.stop()
    robot.stay_silent(1.0)

    assert told(robot) == ["vehicle.standstill_unknown"]


# --- the end of a stop ---------------------------------------------------------------------------


def test_a_task_that_goes_on_ends_the_watch_without_a_word() -> None:
    robot = driving(2.0)
    robot.hold()
    robot.advance(1.0, 1.5)
    robot.release()
    robot.advance(20.0, 2.0)

    assert told(robot) == []


def test_a_task_that_goes_on_takes_the_reason_away() -> None:
    robot = driving(2.0)
    robot.hold()
    robot.advance(10.0, 2.0)
    assert reason(robot) == "STILL_MOVING"
    robot.release()

    assert reason(robot) is None
    assert told(robot) == ["vehicle.still_moving"]


def test_a_second_stop_does_not_begin_the_time_anew() -> None:
    robot = driving(2.0)
    robot.cancel_task()
    robot.advance(3.0, 1.9)
    robot.stop()
    robot.advance(0.5, 1.9)

    assert robot.happened("vehicle.still_moving") == [{"speed_mps": 1.9, "after_s": 3.5}]


def test_it_is_published_at_once() -> None:
    robot = driving(2.0)
    robot.stop()
    robot.advance(3.45, 1.9)
    robot.now += seconds(0.05)
    robot.events.clear()
    outputs = robot.give(Readings((Reading("battery_level", 0.9),), "test"))

    assert outputs.system_state
    assert outputs.vehicle_changed
    assert [event.kind for event in outputs.events] == ["vehicle.still_moving"]


# --- after a restart of the service --------------------------------------------------------------


def test_a_vehicle_that_rolls_on_while_the_service_restarts_is_told() -> None:
    before = driving()
    after = ScriptedRobot(pose=False, good=False, start=before.now)
    after.give(Restored(before.all_kept(), boot=2))
    after.advance(2.0, speed_mps=1.0)
    assert told(after) == []
    assert after.task.status is TaskPhase.PAUSED

    after.advance(1.0, speed_mps=1.0)
    assert told(after) == ["vehicle.still_moving"]
    assert reason(after) == "STILL_MOVING"
