"""What a robot consists of, made from its settings: the same parts live and in a simulation."""

from domain.navigation import Navigation
from domain.onboard import Onboard
from domain.parts.system_model import SmhModel
from domain.simulation.robot import SimulatedRobot
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant
from service.files.robot_file import RobotSettings


def make_onboard(model: SmhModel, robot: RobotSettings, start: Instant) -> Onboard:
    """Return the supervision and the navigation of a robot."""
    limits = robot.to_vehicle_settings().limits
    settings = SupervisionSettings(
        robot.to_signal_settings(),
        robot.to_change_settings(),
        robot.to_task_settings(),
        limits,
    )
    core = Supervision(model, settings, start)
    navigation = Navigation(limits, robot.to_navigation_settings(), core.driving.watch)
    return Onboard(core, navigation)


def make_simulated_robot(
    model: SmhModel, robot: RobotSettings, start: Instant, *, mock: bool
) -> SimulatedRobot:
    """Return the robot itself, simulated.

    Args:
        model: Says which nodes there are.
        robot: What nodes and vehicle are like.
        start: The present.
        mock: Whether signals are published as well.

    Raises:
        UnknownPartError: There are settings of a node that the model does not have.
    """
    nodes, vehicle = robot.to_node_settings(), robot.to_vehicle_settings()
    return SimulatedRobot(model, start, nodes, vehicle, mock=mock)
