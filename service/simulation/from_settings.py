"""The simulated robot that a robot file describes."""

from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.robot import SimulatedRobot
from domain.simulation.vehicle_settings import Noise, Plant, VehicleSettings
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant, seconds
from domain.vehicle import Pose
from service.files.robot_file import RobotSettings
from service.files.robot_settings import NodeBlock
from service.files.vehicle_block import VehicleBlock


def make_simulated_robot(
    model: SmhModel,
    robot: RobotSettings,
    start: Instant,
    *,
    mock: bool,
    memory: object = None,
) -> SimulatedRobot:
    """Return a simulated robot.

    Args:
        model: Defines the nodes.
        robot: Settings of nodes and vehicle.
        start: Start time of the simulation.
        mock: Whether mock signals are published as well.
        memory: What its `memory` returned in an earlier run; None: nodes and vehicle begin anew.

    Raises:
        UnknownPartError: The settings name a node that the model does not have.
    """
    nodes = {PartName(name): node_settings(block) for name, block in robot.nodes.items()}
    vehicle = vehicle_settings(robot.vehicle)
    return SimulatedRobot(model, start, nodes, vehicle, mock=mock, memory=memory)


def node_settings(block: NodeBlock) -> NodeSettings:
    """Return the settings of a simulated node, with defaults for what the block leaves out."""
    usual = NodeSettings()
    return NodeSettings(
        configure=_duration(block.configure_s, usual.configure),
        activate=_duration(block.activate_s, usual.activate),
        deactivate=_duration(block.deactivate_s, usual.deactivate),
        cleanup=_duration(block.cleanup_s, usual.cleanup),
        shutdown=_duration(block.shutdown_s, usual.shutdown),
        set_parameters=_duration(block.set_parameters_s, usual.set_parameters),
        fault=Fault(block.fault) if block.fault else None,
    )


def vehicle_settings(block: VehicleBlock) -> VehicleSettings:
    """Return the settings of the simulated vehicle."""
    pose, plant, noise = block.pose, block.plant, block.plant.noise
    return VehicleSettings(
        Pose(pose.x_m, pose.y_m, pose.yaw_rad),
        Plant(
            plant.acceleration_mps2,
            plant.braking_mps2,
            plant.steering_rate_radps,
            plant.steering_lag_s,
            plant.speed_lag_s,
            seconds(plant.delay_s),
            Noise(noise.position_m, noise.yaw_rad, noise.speed_mps, noise.seed),
        ),
        block.to_limits(),
    )


def _duration(own: float | None, usual: Duration) -> Duration:
    return usual if own is None else seconds(own)
