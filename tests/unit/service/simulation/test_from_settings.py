"""The settings of a robot file as the simulated robot knows them."""

from typing import Any

import pytest

from domain.errors import UnknownPartError
from domain.inputs import NodeReport, Readings, VehicleReport
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.robot import SimulatedRobot
from domain.simulation.vehicle_settings import Noise, Plant, VehicleSettings
from domain.timebase import seconds
from domain.vehicle import Pose, VehicleLimits
from service.files.robot_file import RobotSettings
from service.files.robot_settings import NodeBlock
from service.files.vehicle_block import VehicleBlock
from service.simulation.from_settings import make_simulated_robot, node_settings, vehicle_settings
from tests.support.models import ARM, actuation_model

MODEL = actuation_model()
START = seconds(50.0)
EVERYTHING: dict[str, Any] = {
    "wheelbase_m": 2.5,
    "max_steering_angle_rad": 0.5,
    "max_speed_mps": 6.5,
    "pose": {"x_m": 1.5, "y_m": -2.5, "yaw_rad": 0.75},
    "plant": {
        "acceleration_mps2": 1.25,
        "braking_mps2": 2.25,
        "steering_rate_radps": 0.11,
        "steering_lag_s": 0.2,
        "speed_lag_s": 0.3,
        "delay_s": 0.1,
        "noise": {"position_m": 0.02, "yaw_rad": 0.01, "speed_mps": 0.05, "seed": 42},
    },
}


def settings(**said: object) -> RobotSettings:
    return RobotSettings.model_validate(said)


def simulated(robot: RobotSettings, *, mock: bool = False) -> SimulatedRobot:
    return make_simulated_robot(MODEL, robot, START, mock=mock)


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


def test_a_node_is_usual_except_for_what_is_said() -> None:
    assert node_settings(NodeBlock()) == NodeSettings()
    block = NodeBlock(
        configure_s=1.5,
        activate_s=0,
        deactivate_s=2,
        cleanup_s=3,
        shutdown_s=4,
        set_parameters_s=0.5,
        fault="silent",
    )
    assert node_settings(block) == NodeSettings(
        configure=seconds(1.5),
        activate=0,
        deactivate=seconds(2),
        cleanup=seconds(3),
        shutdown=seconds(4),
        set_parameters=seconds(0.5),
        fault=Fault.SILENT,
    )


@pytest.mark.parametrize("fault", Fault)
def test_every_fault_can_be_there_from_the_start(fault: Fault) -> None:
    assert node_settings(NodeBlock.model_validate({"fault": str(fault)})).fault is fault


def test_to_be_restored_makes_no_other_node() -> None:
    assert node_settings(NodeBlock(on_return="restore")) == NodeSettings()


def test_a_vehicle_of_which_nothing_is_said_is_ideal_and_stands_at_the_origin() -> None:
    assert vehicle_settings(VehicleBlock()) == VehicleSettings()


def test_everything_that_is_said_holds() -> None:
    assert vehicle_settings(VehicleBlock.model_validate(EVERYTHING)) == VehicleSettings(
        Pose(1.5, -2.5, 0.75),
        Plant(
            acceleration_mps2=1.25,
            braking_mps2=2.25,
            steering_rate_radps=0.11,
            steering_lag_s=0.2,
            speed_lag_s=0.3,
            delay=seconds(0.1),
            noise=Noise(position_m=0.02, yaw_rad=0.01, speed_mps=0.05, seed=42),
        ),
        VehicleLimits(
            wheelbase_m=2.5,
            max_steering_angle_rad=0.5,
            max_speed_mps=6.5,
            braking_mps2=2.25,
            steering_rate_radps=0.11,
            steering_delay_s=0.2 + 0.1,
        ),
    )


def test_what_is_left_out_of_a_part_is_as_usual() -> None:
    block = VehicleBlock.model_validate({"plant": {"noise": {"seed": 3}}, "pose": {"y_m": 2.0}})

    assert vehicle_settings(block) == VehicleSettings(
        Pose(0.0, 2.0, 0.0), Plant(noise=Noise(seed=3)), VehicleLimits()
    )
