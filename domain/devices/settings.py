"""What each device of a robot owns, and what it does when it is cut off."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from domain.computers import ComputerName
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Duration, seconds, to_seconds


@dataclass(frozen=True, slots=True)
class OfflineSettings:
    """What a device does on its own while its supervisor cannot be heard."""

    after: Duration = seconds(2)
    """How long after the last echo of the supervisor; at least until it counts as lost."""
    targets: Mapping[PartName, StateAndMode] = field(default_factory=dict)
    """What is requested then, of parts that are all its own, in this order."""
    reactions: bool = False
    """Whether its reactions act; otherwise they only tell that they would."""

    @property
    def words(self) -> str:
        """Return what it does, in words for an operator."""
        wanted = [f"{part} to {target.label}" for part, target in self.targets.items()]
        what = ", ".join(wanted) or "nothing changes"
        acts = "; its reactions act" if self.reactions else ""
        return f"after {to_seconds(self.after):g} s: {what}{acts}"


NOTHING_OFFLINE = OfflineSettings()
"""Nothing changes: its nodes stay as they are."""


@dataclass(frozen=True, slots=True)
class DeviceSettings:
    """One device: it alone commands its nodes."""

    name: ComputerName
    nodes: tuple[PartName, ...]
    """In the order of the model file."""
    signals: tuple[str, ...] = ()
    """Signals that are read there; monitors of them are computed on each computer."""
    offline: OfflineSettings = NOTHING_OFFLINE


@dataclass(frozen=True, slots=True)
class LeadSettings:
    """What a device must know to judge whose word counts."""

    device: ComputerName
    offline: OfflineSettings = NOTHING_OFFLINE
    lost: Duration = seconds(1.5)
    """How long after the last echo the supervisor counts as lost."""
    supervisor_at: str = ""
    """Where the supervisor is, for people; empty: on the same computer."""

    @property
    def waits(self) -> Duration:
        """Return how long after the loss was noticed the device acts on its own."""
        return max(self.offline.after - self.lost, 0)


def ownership_text(devices: Iterable[DeviceSettings], late: Duration, lost: Duration) -> str:
    """Return what all computers of a robot must agree on, as one canonical text.

    Two robot files that mean the same give the same text.

    Args:
        devices: All devices of the robot.
        late: After which silence a computer counts as late.
        lost: After which silence it counts as lost.
    """
    owned = {device.name: _plain(device) for device in devices}
    return json.dumps({"devices": owned, "late": late, "lost": lost}, sort_keys=True)


def _plain(device: DeviceSettings) -> dict[str, object]:
    offline = device.offline
    return {
        "nodes": sorted(device.nodes),
        "signals": sorted(device.signals),
        "after": offline.after,
        # Later targets supersede earlier ones, so that their order counts.
        "targets": [[part, target.label] for part, target in offline.targets.items()],
        "reactions": offline.reactions,
    }
