import numpy as np
import pytest

from domain.actor import Actor
from domain.errors import InvalidValueError, UnknownProcessError
from domain.external_navigation import ExternalNavigation
from domain.inputs import Reading, Readings, TaskRequest, TimePassed, VehicleReport
from domain.navigation import Navigation
from domain.paths.path import Path
from domain.timebase import seconds
from domain.vehicle import Pose, VehicleState
from service.files.robot_file import RobotSettings
from service.onboard_parts import make_onboard
from tests.support.models import ARM, BASE, actuation_model

MODEL = actuation_model()
START = seconds(50.0)


def settings(**said: object) -> RobotSettings:
    return RobotSettings.model_validate(said)


def test_the_supervision_is_of_the_model() -> None:
    onboard = make_onboard(MODEL, settings(), START)

    assert set(onboard.core.parts()) == set(MODEL.parts)


def test_signals_are_judged_as_the_settings_say() -> None:
    onboard = make_onboard(MODEL, settings(signals={"battery_level": {"threshold": 0.3}}), START)
    onboard.handle(Readings((Reading("battery_level", 0.4),), "test"), START)
    assert "BATTERY_LOW" not in onboard.core.system_state().errors

    onboard.handle(Readings((Reading("battery_level", 0.2),), "test"), START)
    assert "BATTERY_LOW" in onboard.core.system_state().errors


def test_navigation_is_as_the_settings_say() -> None:
    robot = settings(driving={"max_cross_track_m": 1.5, "braking_mps2": 0.5})
    navigation = make_onboard(MODEL, robot, START).navigation

    assert navigation.settings == robot.to_navigation_settings()
    assert navigation.settings.max_cross_track_m == 1.5
    assert navigation.settings.speed.braking_mps2 == 0.5


CONTROLLER = {"navigation": {"action": "/go", "silent_for_s": 2.5, "end_tolerance_m": 0.2}}


def test_an_external_controller_drives_a_real_robot_whose_file_names_one() -> None:
    robot = settings(backend="ros2", ros2=CONTROLLER, driving={"max_cross_track_m": 1.5})
    onboard = make_onboard(MODEL, robot, START)

    assert isinstance(onboard.navigation, ExternalNavigation)
    assert onboard.navigation.settings.max_cross_track_m == 1.5
    onboard.handle(TimePassed(), START)
    hold = onboard.core.driving.holds["navigation"]
    assert hold.reason == "no controller was seen at /go yet"
    controller = robot.to_controller_settings()
    assert controller is not None
    assert (controller.silent_for, controller.end_tolerance_m) == (seconds(2.5), 0.2)


@pytest.mark.parametrize("said", [{}, {"backend": "simulated"}])
def test_the_trackers_on_board_drive_a_simulated_one(said: dict[str, str]) -> None:
    onboard = make_onboard(MODEL, settings(ros2=CONTROLLER, **said), START)
    assert isinstance(onboard.navigation, Navigation)


def task(begins_at_m: float, speed_mps: float) -> TaskRequest:
    """Return a task along the x axis."""
    x = np.linspace(begins_at_m, begins_at_m + 20.0, 41)
    path = Path(np.column_stack((x, np.zeros_like(x), np.zeros_like(x))))
    return TaskRequest(path, 0, "pure_pursuit", speed_mps, Actor("operator"))


@pytest.mark.parametrize(
    ("begins_at_m", "speed_mps", "refused"),
    [(8.0, 5.0, ""), (9.5, 5.0, "at most 9 m"), (8.0, 5.5, "5")],
    ids=["as far and as fast as may be", "too far", "too fast"],
)
def test_tasks_are_judged_as_the_settings_say(
    begins_at_m: float, speed_mps: float, refused: str
) -> None:
    robot = settings(vehicle={"max_speed_mps": 5.0}, driving={"max_start_distance_m": 9.0})
    onboard = make_onboard(MODEL, robot, START)
    onboard.handle(VehicleReport(VehicleState(Pose(0.0, 0.0, 0.0), 0.0, 0.0)), START)

    if refused:
        with pytest.raises(InvalidValueError, match=refused):
            onboard.handle(task(begins_at_m, speed_mps), START)
    else:
        assert onboard.handle(task(begins_at_m, speed_mps), START).task is not None


def test_each_computer_runs_the_processes_of_its_own_nodes() -> None:
    process = {"process": {"command": ["node"]}}
    said: dict[str, object] = {
        "nodes": {"drive_base": process, "manipulator": process},
        "devices": {"arm": {"parts": ["manipulator"]}},
    }
    supervisor = make_onboard(MODEL, settings(**said), START).core
    device = make_onboard(MODEL, settings(**said, device="arm"), START).core

    assert supervisor.processes.view(BASE).node == BASE
    with pytest.raises(UnknownProcessError):
        supervisor.processes.view(ARM)
    assert device.processes.view(ARM).node == ARM
