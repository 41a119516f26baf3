"""Settings of the core, which say what it supervises besides its model."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from domain.changes.settings import ChangeSettings
from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings, LeadSettings
from domain.health.checkpoints import CheckpointSettings
from domain.health.signals import SignalSettings, default_signals
from domain.processes.settings import ProcessSettings
from domain.reactions.settings import RuleSettings
from domain.state_and_mode import PartName
from domain.tasks.settings import TaskSettings
from domain.timebase import Duration, seconds
from domain.vehicle import VehicleLimits


@dataclass(frozen=True, slots=True)
class SupervisionSettings:
    """Settings of the core."""

    signals: tuple[SignalSettings, ...] = field(default_factory=default_signals)
    changes: ChangeSettings = field(default_factory=ChangeSettings)
    tasks: TaskSettings = field(default_factory=TaskSettings)
    vehicle: VehicleLimits = field(default_factory=VehicleLimits)
    rules: RuleSettings = field(default_factory=RuleSettings)
    checkpoints: Mapping[PartName, CheckpointSettings] = field(default_factory=dict)
    """What is supervised of the checkpoints of nodes."""
    processes: Mapping[PartName, ProcessSettings] = field(default_factory=dict)
    """Nodes whose processes this computer runs, and when it starts them again."""
    lead: LeadSettings | None = None
    """Of a device, which follows a supervisor; None: this computer follows nobody."""
    devices: Mapping[ComputerName, DeviceSettings] = field(default_factory=dict)
    """Computers that own nodes; empty: all nodes are those of this one."""
    reactions_of_devices: Mapping[str, ComputerName] = field(default_factory=dict)
    """By name of a reaction, the device that decides about it: all that it rests on is there."""
    devices_heard_within: Duration = seconds(1.5)
    """How long rules, fallbacks and reactions wait for devices after a start."""

    @property
    def device_of(self) -> Mapping[PartName, ComputerName]:
        """Return by node that another computer owns, that computer."""
        return {node: name for name, each in self.devices.items() for node in each.nodes}

    @property
    def nodes_of_devices(self) -> Mapping[PartName, Sequence[PartName]]:
        """Return by device, whose errors are named as those of parts are, the nodes it owns."""
        return {PartName(name): each.nodes for name, each in self.devices.items()}

    peers: tuple[ComputerName, ...] = ()
    """The other computers of the robot, which stop it as well; empty: it has one computer."""
