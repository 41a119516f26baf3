"""Times of the link, and what belongs to whom."""

from dataclasses import dataclass, replace
from typing import NamedTuple

from domain.state_and_mode import PartName
from domain.timebase import Duration, seconds


@dataclass(frozen=True, slots=True)
class LinkSettings:
    """Times of the link; the same on each computer of a robot."""

    late: Duration = seconds(0.5)
    """Without a sign of life, or without an echo of one's own, for this long: late."""
    lost: Duration = seconds(1.5)
    """The same, and for this long: lost."""
    beat: Duration = seconds(0.1)
    """From one beat to the next, between the supervisor and a device."""
    slow_beat: Duration = seconds(0.5)
    """From one beat to the next between devices, which tell each other of stops only."""
    urgent: Duration = seconds(0.1)
    """From one beat to the next while the other has not acknowledged the stops."""
    report: Duration = seconds(1)
    """From one complete report to the next."""
    missed_report: Duration = seconds(0.5)
    """The same while the supervisor still waits for one."""

    @property
    def slowly(self) -> "LinkSettings":
        """Return the settings of the link between two devices: five beats may be missed."""
        lost = max(self.lost, 5 * self.slow_beat)
        return replace(self, late=lost, lost=lost, beat=self.slow_beat)


class Owned(NamedTuple):
    """What belongs to a device: nobody else may speak for it."""

    nodes: tuple[PartName, ...]
    signals: tuple[str, ...] = ()
    """Signals that are read there."""
    systems: tuple[PartName, ...] = ()
    """Systems whose nodes are all its own."""
