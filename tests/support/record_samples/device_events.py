"""Values of the events of devices."""

from collections.abc import Mapping

from domain.computers import ComputerName, DeviceState
from domain.events.devices import (
    DeviceConflict,
    DeviceConnected,
    DeviceLate,
    DeviceLost,
    DeviceReported,
)

_ARM = ComputerName("arm")
_REASON = 'Größe ≤ 3 — "gripper\\jam"'

DEVICE_EVENTS: Mapping[str, tuple[object, ...]] = {
    "device.conflict": (DeviceConflict(device=_ARM, reason=_REASON),),
    "device.connected": (
        DeviceConnected(device=_ARM, was=DeviceState.NEVER_SEEN, restarted=False),
        DeviceConnected(device=_ARM, was=DeviceState.LOST, restarted=True),
    ),
    "device.late": (DeviceLate(device=_ARM, reason=_REASON),),
    "device.lost": (DeviceLost(device=_ARM, reason=_REASON),),
    "device.reported": (
        DeviceReported(device=_ARM, version="0.9.1", autonomous=True),
        DeviceReported(device=_ARM, version=None, autonomous=False),
    ),
}
