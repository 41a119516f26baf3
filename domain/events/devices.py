"""Events of the other computers of a robot, as the supervisor sees them."""

from dataclasses import dataclass

from domain.computers import ComputerName, DeviceState
from domain.events.event import Event, because


@dataclass(frozen=True, slots=True)
class DeviceConnected(Event):
    """A device is connected, for the first time or again."""

    kind = "device.connected"
    is_input = True

    device: ComputerName
    was: DeviceState
    restarted: bool
    """Another run of it is dealt with than before."""

    def _words(self) -> str:
        how = " after a restart" if self.restarted else ""
        return f"device {self.device} is connected{how}"

    @property
    def notable(self) -> bool:
        """Tell whether it was away, and not only late."""
        return self.restarted or self.was is not DeviceState.LATE


@dataclass(frozen=True, slots=True)
class DeviceLate(Event):
    """A device has not been heard for a moment; it is still commanded."""

    kind = "device.late"
    is_input = True
    is_notable = False

    device: ComputerName
    reason: str
    """A sentence."""

    def _words(self) -> str:
        return self.reason or f"device {self.device} is late"


@dataclass(frozen=True, slots=True)
class DeviceLost(Event):
    """A device is not connected; its nodes are unreachable until it is again."""

    kind = "device.lost"
    is_input = True

    device: ComputerName
    reason: str
    """A sentence."""

    def _words(self) -> str:
        return self.reason or f"device {self.device} is not connected"


@dataclass(frozen=True, slots=True)
class DeviceConflict(Event):
    """A process that answers by the name of a device is not dealt with, and why."""

    kind = "device.conflict"
    is_input = True

    device: ComputerName
    reason: str

    def _words(self) -> str:
        return because(f"conflict about device {self.device}", self.reason)


@dataclass(frozen=True, slots=True)
class DeviceReported(Event):
    """Something else is known of a device: its version, its session, or what it does."""

    kind = "device.reported"
    is_input = True

    device: ComputerName
    version: str | None
    autonomous: bool

    def _words(self) -> str:
        if self.autonomous:
            return f"device {self.device} acts on its own"
        return f"device {self.device} runs version {self.version or 'unknown'}"

    @property
    def notable(self) -> bool:
        """Tell whether it acts on its own."""
        return self.autonomous
