import numpy as np
import pytest

from domain.actor import Actor
from domain.errors import InvalidValueError, UnknownPartError
from domain.inputs import NodeReport, Reading, Readings, TaskRequest, VehicleReport
from domain.paths.path import Path
from domain.simulation.robot import SimulatedRobot
from domain.timebase import seconds
from domain.vehicle import Pose, VehicleState
from service.files.robot_file import RobotSettings
from service.robot_parts import make_onboard, make_simulated_robot
from tests.support.models import ARM, actuation_model

MODEL = actuation_model()
START = seconds(50.0)


def settings(**said: object) -> RobotSettings:
    return RobotSettings.model_validate(said)


def simulated(robot: RobotSettings, *, mock: bool = False) -> SimulatedRobot:
    return make_simulated_robot(MODEL, robot, START, mock=mock)


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


def test_nodes_and_vehicle_are_as_the_settings_say() -> None:
    robot = settings(
        nodes={ARM: {"fault": "die"}}, vehicle={"pose": {"x_m": 3.0, "y_m": 4.0, "yaw_rad": 0.5}}
    )
    said = simulated(robot).advance(START + seconds(2))

    assert NodeReport(ARM, reachable=False) in said
    (pose,) = {message.state.pose for message in said if isinstance(message, VehicleReport)}
    assert pose == Pose(3.0, 4.0, 0.5)


def test_it_begins_at_the_start_and_not_before() -> None:
    assert simulated(settings(), mock=True).wake_at() == START


@pytest.mark.parametrize("mock", [True, False])
def test_signals_are_mocked_where_that_is_asked(mock: bool) -> None:
    said = simulated(settings(), mock=mock).advance(START)

    assert any(isinstance(message, Readings) for message in said) is mock


def test_settings_of_a_node_that_is_not_there_are_refused() -> None:
    with pytest.raises(UnknownPartError, match="tail"):
        simulated(settings(nodes={"tail": {}}))
