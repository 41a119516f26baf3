"""Settings of a simulated node: durations and faults."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType

from domain.lifecycle import Transition
from domain.timebase import Duration, seconds


class Fault(StrEnum):
    """A fault of a node; it lasts until it is replaced or removed."""

    SLOW = "slow"
    """Transitions and parameter sets take `SLOWDOWN` times as long."""
    REFUSE = "refuse"
    """The node rejects every transition and parameter set."""
    FAIL = "fail"
    """Callbacks report failure; the lifecycle table gives the next state."""
    ERROR = "error"
    """Callbacks end in `errorprocessing`, and from there in `unconfigured`."""
    SILENT = "silent"
    """The node executes commands, but sends no answers and reports."""
    DIE = "die"
    """The process has died, and its work is lost; removing the fault restarts it."""

    @property
    def is_mute(self) -> bool:
        """Tell whether a node with this fault sends nothing."""
        return self in NOTICED_AFTER


SLOWDOWN = 20

NOTICED_AFTER: Mapping[Fault, Duration] = MappingProxyType(
    {Fault.SILENT: seconds(3.0), Fault.DIE: seconds(1.0)}
)
"""How long a node must send nothing before it is reported as unreachable."""


@dataclass(frozen=True, slots=True)
class NodeSettings:
    """Durations of one simulated node, and its initial fault; the defaults suit a small node."""

    configure: Duration = seconds(0.3)
    activate: Duration = seconds(0.2)
    deactivate: Duration = seconds(0.2)
    cleanup: Duration = seconds(0.2)
    shutdown: Duration = seconds(0.2)
    set_parameters: Duration = seconds(0.02)
    process_error: Duration = seconds(0.5)
    """Time from `errorprocessing` to `unconfigured`."""
    fault: Fault | None = None
    """Fault from the start; None: none."""
    plain: bool = False
    """Whether the node has parameters only, and no lifecycle."""

    def time_of(self, transition: Transition) -> Duration:
        """Return the duration of the callback of `transition`."""
        match transition:
            case Transition.CONFIGURE:
                return self.configure
            case Transition.ACTIVATE:
                return self.activate
            case Transition.DEACTIVATE:
                return self.deactivate
            case Transition.CLEANUP:
                return self.cleanup
            case Transition.SHUTDOWN:
                return self.shutdown
