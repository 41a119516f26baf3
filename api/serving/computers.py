"""The link of a service to the other computers of its robot: names its adapter."""

from api.distribution import installed_version
from api.serving.misuse import MisuseError
from domain.parts.system_model import SmhModel
from service.clock import Clock
from service.files.robot_file import RobotSettings
from service.link.device_end import DeviceEnd
from service.link.making import make_end
from service.link.place import Place
from service.link.port import Link
from service.link.supervisor_end import SupervisorEnd

_NO_ZENOH = "install what the link between computers needs: pip install 'pilothouse[link]'"


def make_link(
    place: Place, model: SmhModel, robot: RobotSettings, clock: Clock, *, insecure: bool
) -> SupervisorEnd | DeviceEnd:
    """Return the end of the link of this computer; nothing runs yet.

    Args:
        place: Which computer it is.
        model: Of the whole robot.
        robot: Settings of the whole robot.
        clock: Of the service.
        insecure: Whether the link may go over a network without certificates.

    Raises:
        MisuseError: The link cannot be made as the robot file says; the message says what to do.
    """
    link = _over_zenoh(place, robot, insecure=insecure)
    return make_end(place, model, robot, link, clock, installed_version())
