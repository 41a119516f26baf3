"""Which computer owns what, in several arrangements of one robot."""

from collections.abc import Mapping
from dataclasses import dataclass

from domain.computers import ComputerName
from domain.devices.settings import NOTHING_OFFLINE, DeviceSettings, OfflineSettings
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.models import ARM, BASE, inactive, nested_model

LIDAR = PartName("lidar")
MODEL: SmhModel = nested_model()


@dataclass(frozen=True)
class Arrangement:
    """Who owns which nodes; those of no device are the supervisor's own."""

    devices: Mapping[ComputerName, DeviceSettings]
    restored: frozenset[PartName] = frozenset()
    """Nodes with `on_return: restore`."""

    @property
    def local_nodes(self) -> tuple[PartName, ...]:
        """Return the nodes of the supervisor itself."""
        return tuple(node for node in MODEL.nodes if self.owner_of(node) is None)

    def owner_of(self, node: PartName) -> ComputerName | None:
        """Return the device that owns a node; None: it is the supervisor's own."""
        owners = (name for name, device in self.devices.items() if node in device.nodes)
        return next(owners, None)

    def __str__(self) -> str:
        """Return who owns what, and what is restored."""
        owned = (f"{name} owns {', '.join(device.nodes)}" for name, device in self.devices.items())
        return "; ".join((*owned, f"restored: {', '.join(sorted(self.restored)) or 'none'}"))


def _device(
    name: str, nodes: tuple[PartName, ...], offline: OfflineSettings = NOTHING_OFFLINE
) -> DeviceSettings:
    return DeviceSettings(ComputerName(name), nodes, offline=offline)


def _arrangement(*devices: DeviceSettings, restored: frozenset[PartName]) -> Arrangement:
    return Arrangement({device.name: device for device in devices}, restored)


_BASE_RESTS = OfflineSettings(seconds(2), {BASE: inactive()})
_AT_ONCE = OfflineSettings(seconds(1.5), {BASE: inactive(), ARM: inactive()})
ARRANGEMENTS = tuple(
    _arrangement(*devices, restored=restored)
    for devices in (
        (_device("base", (BASE,), _BASE_RESTS), _device("arm", (ARM,))),
        (
            _device("base", (BASE,), _BASE_RESTS),
            _device("arm", (ARM,)),
            _device("eye", (LIDAR,)),
        ),
        (_device("body", (BASE, ARM), _AT_ONCE), _device("eye", (LIDAR,))),
    )
    for restored in (frozenset[PartName](), frozenset({BASE, ARM}))
)
