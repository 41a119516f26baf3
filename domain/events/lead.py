"""Events of a device: whether it hears its supervisor, what that orders, and what it does alone."""

from dataclasses import dataclass

from domain.events.event import Event, because
from domain.state_and_mode import PartName, StateAndMode


@dataclass(frozen=True, slots=True)
class SupervisorConnected(Event):
    """The device hears its supervisor, and is heard: it follows."""

    kind = "supervisor.connected"
    is_input = True

    device: str

    def _words(self) -> str:
        return f"device {self.device} follows its supervisor"


@dataclass(frozen=True, slots=True)
class SupervisorLate(Event):
    """The device has not heard its supervisor for a while; it still follows."""

    kind = "supervisor.late"
    is_input = True

    device: str
    reason: str

    def _words(self) -> str:
        return because(f"device {self.device} hears its supervisor late", self.reason)


@dataclass(frozen=True, slots=True)
class SupervisorLost(Event):
    """The device is cut off from its supervisor: it carries out no order of before."""

    kind = "supervisor.lost"
    is_input = True

    device: str
    reason: str

    def _words(self) -> str:
        return because(f"device {self.device} is cut off from its supervisor", self.reason)


@dataclass(frozen=True, slots=True)
class OrderTaken(Event):
    """The supervisor has a node of the device do something, and it is asked to."""

    kind = "order.taken"
    is_input = True
    is_notable = False

    node: PartName
    action: str
    """A lifecycle transition, or `set_parameters`."""

    def _words(self) -> str:
        return f"the supervisor orders {self.node}: {self.action}"


@dataclass(frozen=True, slots=True)
class OrderRefused(Event):
    """The supervisor has a node of the device do something that the device does not allow."""

    kind = "order.refused"
    is_input = True

    node: PartName
    action: str
    """A lifecycle transition, or `set_parameters`."""
    reason: str

    def _words(self) -> str:
        return because(f"an order is refused, {self.node}: {self.action}", self.reason)


@dataclass(frozen=True, slots=True)
class DeviceActsAlone(Event):
    """A device that is cut off does what `offline` of the robot file says."""

    kind = "device.acts_alone"
    is_input = True

    device: str
    does: str
    """What it does, in words."""

    def _words(self) -> str:
        return because(f"device {self.device} acts alone", self.does)


@dataclass(frozen=True, slots=True)
class DeviceTargetLeft(Event):
    """A target of `offline` is not pursued, for a reason; it is not tried again."""

    kind = "device.target_left"

    device: str
    part: PartName
    target: StateAndMode
    reason: str

    def _words(self) -> str:
        what = f"device {self.device} does not bring {self.part} to {self.target.label}"
        return because(what, self.reason)


@dataclass(frozen=True, slots=True)
class DeviceFollowsAgain(Event):
    """A device that acted alone hears its supervisor again; what is stays as it is."""

    kind = "device.follows_again"

    device: str

    def _words(self) -> str:
        return f"device {self.device} follows its supervisor again, and acts alone no longer"
