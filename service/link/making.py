"""Makes the end of the link that a computer has, from the settings of its robot."""

import secrets
from collections.abc import Callable

from domain.computers import SUPERVISOR, Incarnation
from domain.devices.owned_facts import is_own
from domain.devices.settings import DeviceSettings
from domain.link.device_link import DeviceLink
from domain.link.messages import Terms
from domain.link.settings import LinkSettings, Owned
from domain.link.supervisor_link import SupervisorLink
from domain.parts.system_model import SmhModel
from service.clock import Clock
from service.files.robot_file import RobotSettings
from service.link.device_end import DeviceEnd
from service.link.fingerprint import fingerprint_of, model_fingerprint
from service.link.place import Place
from service.link.port import Link
from service.link.status import LinkStatus
from service.link.supervisor_end import SupervisorEnd

_BYTES_OF_ID = 16


def random_id() -> str:
    """Return what names one run of a process, or one session: it never comes twice."""
    return secrets.token_hex(_BYTES_OF_ID)


def make_end(
    place: Place,
    model: SmhModel,
    robot: RobotSettings,
    link: Link,
    clock: Clock,
    version: str = "",
    new_id: Callable[[], str] = random_id,
) -> SupervisorEnd | DeviceEnd:
    """Return the end of the link of one computer; nothing runs yet.

    Args:
        place: Which computer it is.
        model: Of the whole robot.
        robot: Settings of the whole robot.
        link: Carries its messages.
        clock: Of the service.
        version: Of Pilothouse, for people.
        new_id: Returns what names a run, or a session.
    """
    times = LinkSettings(robot.link.late, robot.link.lost)
    terms = terms_of(model, robot, version)
    owned = {device.name: _owned(device, model) for device in robot.to_device_settings(model)}
    run, now = Incarnation(new_id()), clock.now()
    slow = times.slowly.beat
    if place.is_supervisor:
        machine = SupervisorLink(terms, owned, run, now, times)
        status = LinkStatus(dict.fromkeys(owned, times.beat))
        return SupervisorEnd(machine, link, clock, status)
    beats = {name: times.beat if name == SUPERVISOR else slow for name in place.others}
    others = [name for name in place.devices if name != place.name]
    device = DeviceLink(place.name, terms, others, owned[place.name], run, new_id, now, times)
    return DeviceEnd(device, link, clock, LinkStatus(beats))


def terms_of(model: SmhModel, robot: RobotSettings, version: str = "") -> Terms:
    """Return what the computers of a robot must agree on."""
    ownership = fingerprint_of(robot.ownership_text(model))
    return Terms(model_fingerprint(model), ownership, version=version)


def _owned(device: DeviceSettings, model: SmhModel) -> Owned:
    systems = tuple(system for system in model.systems if is_own(system, device.nodes, model))
    return Owned(device.nodes, device.signals, systems)
