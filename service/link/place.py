"""Where a computer is among those of its robot."""

from collections.abc import Sequence
from dataclasses import dataclass

from domain.computers import SUPERVISOR, ComputerName
from service.files.robot_file import RobotSettings
from service.link.endpoints import Endpoints, of_device, of_supervisor


@dataclass(frozen=True, slots=True)
class Place:
    """One of several computers of a robot, and how it reaches the others."""

    name: ComputerName
    devices: tuple[ComputerName, ...]
    """All devices of the robot, in the order of its file."""
    endpoints: Endpoints

    @property
    def is_supervisor(self) -> bool:
        """Tell whether it is the supervisor."""
        return self.name == SUPERVISOR

    @property
    def others(self) -> tuple[ComputerName, ...]:
        """Return all other computers of the robot."""
        return tuple(name for name in (SUPERVISOR, *self.devices) if name != self.name)

    @property
    def words(self) -> str:
        """Return who is expected where, for the operator who starts it."""
        if self.is_supervisor:
            return f"{', '.join(self.devices)} are expected at {', '.join(self.endpoints.listen)}"
        return f"the supervisor, whose word counts, is expected at {self.endpoints.connect[0]}"


def place_in(robot: RobotSettings, listen: Sequence[str] = ()) -> Place | None:
    """Return where the computer is that the settings are read for; None: it is the only one.

    Args:
        robot: Of the whole robot; `device` says which computer it is.
        listen: Where it listens, if that is not as the settings say.
    """
    if not robot.devices:
        return None
    name = SUPERVISOR if robot.device is None else ComputerName(robot.device)
    of_this = of_supervisor if name == SUPERVISOR else of_device
    endpoints = of_this(robot.link.listen, robot.link.connect, listen)
    return Place(name, tuple(map(ComputerName, robot.devices)), endpoints)
