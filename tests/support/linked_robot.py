"""A robot of several computers in one process, each with a core, nodes and an end of the link."""

import asyncio
from collections.abc import Iterable, Mapping
from typing import Any

from domain.computers import SUPERVISOR, ComputerName
from domain.parts.system_model import SmhModel
from service.clock import Clock
from service.composite import CompositeRobot
from service.files.computer_share import share_of
from service.files.model_file import LoadedModel
from service.files.robot_file import RobotSettings
from service.link.making import make_end
from service.link.place import place_in
from service.link.port import Link
from service.link.supervisor_end import RemoteNodes, SupervisorEnd
from service.onboard_parts import make_onboard
from service.ports import NodeBackend
from service.simulation.from_settings import make_simulated_robot
from service.simulation.simulated import SimulatedBackend
from service.supervisor import Supervisor

DEVICES: Mapping[str, Any] = {
    "base": {"parts": ["drive_base"]},
    "arm": {"parts": ["manipulator"]},
}
"""Of `actuation_model`."""


def settings_of(name: str, devices: Mapping[str, Any] = DEVICES, **more: object) -> RobotSettings:
    """Return the settings of a robot as one computer has them."""
    device = None if name == SUPERVISOR else name
    return RobotSettings.model_validate({"devices": devices, "device": device, **more})


def make_computer(
    model: SmhModel, robot: RobotSettings, link: Link, clock: Clock
) -> tuple[Supervisor, SimulatedBackend]:
    """Return the service of one computer that does not run yet, and the nodes that it simulates.

    Args:
        model: Of the whole robot.
        robot: Its settings; `device` says which computer it is.
        link: Of this computer.
        clock: Of this computer.
    """
    share, now = share_of(model, robot), clock.now()
    simulated = make_simulated_robot(share.local_model, share.local_robot, now, mock=False)
    if robot.device is not None:
        simulated.vehicle.set_reporting(False, now)
    backend = SimulatedBackend(simulated, clock)
    place = place_in(robot)
    assert place is not None
    end = make_end(place, model, robot, link, clock)
    nodes: dict[Any, NodeBackend] = dict.fromkeys(share.local_model.nodes, backend)
    if isinstance(end, SupervisorEnd):
        nodes = dict.fromkeys(model.nodes, RemoteNodes(end)) | nodes
    whole = CompositeRobot(nodes, backend)
    loaded = LoadedModel(share.model, (), "")
    onboard = make_onboard(model, robot, now)
    supervisor = Supervisor(loaded, onboard, clock, whole, backend.readings)
    supervisor.link = end
    return supervisor, backend


class Running:
    """Services that run as tasks of one event loop."""

    def __init__(self) -> None:
        self._tasks: dict[str, asyncio.Task[None]] = {}

    def start(self, name: str, supervisor: Supervisor) -> None:
        """Let a service run."""
        self._tasks[name] = asyncio.create_task(supervisor.run(), name=name)

    async def stop(self, *names: str) -> None:
        """End services, all of them if none is named, as a power cut would."""
        for name in names or tuple(self._tasks):
            task = self._tasks.pop(name)
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)


def names_of(devices: Iterable[str] = DEVICES) -> tuple[ComputerName, ...]:
    """Return the names of all computers."""
    return (SUPERVISOR, *map(ComputerName, devices))
