"""The link of a service to the other computers of its robot: names its adapter."""

from api.distribution import installed_version
from api.serving.misuse import MisuseError
from domain.errors import InvalidValueError
from domain.parts.system_model import SmhModel
from service.clock import Clock
from service.files.robot_file import RobotSettings
from service.link.certificates import Certificates
from service.link.device_end import DeviceEnd
from service.link.making import make_end
from service.link.place import Place
from service.link.port import Link
from service.link.supervisor_end import SupervisorEnd

_NO_ZENOH = "install what links computers: pip install 'pilothouse[link]'"


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


def _over_zenoh(place: Place, robot: RobotSettings, *, insecure: bool) -> Link:
    """Return the link over zenoh; it opens nothing yet.

    Raises:
        MisuseError: Zenoh is not installed, or the robot file lets anybody command the robot.
    """
    try:
        # Imported here, since a robot of one computer does without it.
        from service.link.zenoh_link import ZenohLink
    except ImportError as error:
        raise MisuseError(
            f"the robot file has devices, and {error}. What to do: {_NO_ZENOH}"
        ) from error
    certificates = _certificates(place, robot)
    try:
        return ZenohLink(place.name, place.others, place.endpoints, certificates, insecure=insecure)
    except InvalidValueError as error:
        raise MisuseError(error.message) from error


def _certificates(place: Place, robot: RobotSettings) -> Certificates | None:
    """Return the certificates of this computer; None: it has none."""
    block = robot.link
    if block.ca is None or block.certificate is None or block.key is None:
        return None
    own = (file.replace("{name}", place.name) for file in (block.certificate, block.key))
    return Certificates(block.ca, *own)
