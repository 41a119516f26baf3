"""One device of the robot, at one moment."""

from dataclasses import dataclass

from domain.computers import ComputerName, DeviceState, Incarnation, Session, StopId
from domain.devices.settings import OfflineSettings
from domain.state_and_mode import PartName
from domain.timebase import Instant


@dataclass(frozen=True, slots=True)
class DeviceView:
    """What the supervisor knows of one device."""

    device: ComputerName
    state: DeviceState
    since: Instant
    """When it came to be so."""
    reason: str
    """Why it is late or not connected, as a sentence; empty: it is connected, or nobody said."""
    parts: tuple[PartName, ...]
    """Nodes that it owns, in the order of the model file."""
    offline: OfflineSettings
    """What it does when it is cut off."""
    incarnation: Incarnation | None
    """Its run that is, or was last, dealt with; None: none was yet."""
    session: Session | None
    version: str | None
    """Of Pilothouse there; None: not known."""
    autonomous: bool
    """It acts on its own, as far as it was heard."""
    refused: str
    """Why another process of its name is refused; empty: there is none."""
    stops: tuple[StopId, ...]
    """Emergency stops that are engaged there, as it said last."""

    @property
    def is_connected(self) -> bool:
        """Tell whether it can be commanded."""
        return self.state in (DeviceState.CONNECTED, DeviceState.LATE)
