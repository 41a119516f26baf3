"""Makes the core of a robot from its settings, the same live and in a simulation."""

from collections.abc import Iterable

from domain.computers import SUPERVISOR, ComputerName
from domain.devices.settings import DeviceSettings
from domain.external_navigation import ExternalNavigation
from domain.navigation import Navigation
from domain.onboard import Onboard
from domain.parts.system_model import SmhModel
from domain.processes.settings import ProcessSettings
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant
from service.files.computer_share import reactions_of_devices, share_of
from service.files.robot_file import RobotSettings


def make_onboard(model: SmhModel, robot: RobotSettings, start: Instant) -> Onboard:
    """Return the supervision and the navigation of a robot, or of the share of one device.

    Args:
        model: Of the whole robot.
        robot: Its settings; `device` says which computer this is.
        start: The current time.
    """
    share = share_of(model, robot)
    own = robot.device or SUPERVISOR
    devices = {} if robot.device else {each.name: each for each in robot.to_device_settings(model)}
    elsewhere = {} if robot.device else reactions_of_devices(model, robot)
    model, robot = share.model, share.robot
    limits = robot.to_vehicle_limits()
    settings = SupervisionSettings(
        robot.to_signal_settings(),
        robot.to_change_settings(),
        robot.to_task_settings(),
        limits,
        robot.to_rule_settings(),
        checkpoints=robot.to_checkpoint_settings(),
        processes=_own_processes(robot, devices.values()),
        peers=_peers(robot.devices, own),
        devices=devices,
        reactions_of_devices=elsewhere,
        devices_heard_within=robot.link.lost,
        lead=robot.to_lead_settings(),
    )
    core = Supervision(model, settings, start)
    driving, watch = robot.to_navigation_settings(), core.driving.watch
    controller = robot.to_controller_settings()
    if controller is None:
        return Onboard(core, Navigation(limits, driving, watch))
    return Onboard(core, ExternalNavigation(limits, driving, controller, watch, start))


def _own_processes(
    robot: RobotSettings, devices: Iterable[DeviceSettings]
) -> dict[PartName, ProcessSettings]:
    """Return the processes that this computer runs: a device runs those of its own nodes."""
    elsewhere = {node for device in devices for node in device.nodes}
    settings = robot.to_process_settings()
    return {node: own for node, own in settings.items() if node not in elsewhere}


def _peers(devices: Iterable[str], own: str) -> tuple[ComputerName, ...]:
    """Return the other computers of a robot."""
    if not devices:
        return ()
    return tuple(ComputerName(name) for name in (SUPERVISOR, *devices) if name != own)
