"""The core and the end of the link that each computer of an arrangement runs."""

from collections.abc import Callable
from dataclasses import replace

from domain.changes.settings import ChangeSettings
from domain.computers import SUPERVISOR, ComputerName, Incarnation
from domain.devices.own_signals import signals_of_device
from domain.devices.settings import LeadSettings
from domain.devices.sub_model import sub_model
from domain.health.signals import default_signals
from domain.link.device_link import DeviceLink
from domain.link.messages import Terms
from domain.link.settings import Owned
from domain.link.supervisor_link import SupervisorLink
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant
from tests.support.network_world.robots import MODEL, Arrangement

_SIGNALS = tuple(replace(signal, stale_after=0) for signal in default_signals())
"""Nobody reads them here, and that is no error."""
_TERMS = Terms("model", "ownership", version="1.2.0")


def make_core(name: ComputerName, arrangement: Arrangement, start: Instant) -> Supervision:
    """Return the core of a computer, before its first input."""
    peers = tuple(other for other in (SUPERVISOR, *arrangement.devices) if other != name)
    if name == SUPERVISOR:
        settings = SupervisionSettings(
            _SIGNALS,
            ChangeSettings(restored_nodes=arrangement.restored),
            devices=arrangement.devices,
            peers=peers,
        )
        return Supervision(MODEL, settings, start)
    device = arrangement.devices[name]
    model = sub_model(MODEL, device.nodes, ()).model
    signals = signals_of_device(_SIGNALS, (), model.parts)
    lead = LeadSettings(name, device.offline)
    return Supervision(model, SupervisionSettings(signals, peers=peers, lead=lead), start)


def make_link(
    name: ComputerName,
    arrangement: Arrangement,
    incarnation: Incarnation,
    new_id: Callable[[], str],
    start: Instant,
) -> SupervisorLink | DeviceLink:
    """Return the end of the link of a computer."""
    owned = {device: Owned(each.nodes) for device, each in arrangement.devices.items()}
    if name == SUPERVISOR:
        return SupervisorLink(_TERMS, owned, incarnation, start)
    return DeviceLink(name, _TERMS, list(owned), owned[name], incarnation, new_id, start)
