"""What a simulated node is like: how long it takes, and what can be wrong with it."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType

from domain.lifecycle import Transition
from domain.timebase import Duration, seconds


class Fault(StrEnum):
    """One thing that can be wrong with a node; it lasts until it is replaced or taken away."""

    SLOW = "slow"
    """What is begun takes `SLOWDOWN` times as long."""
    REFUSE = "refuse"
    """Every transition and parameter set is answered with a refusal."""
    FAIL = "fail"
    """A callback that ends reports failure: the node goes where the lifecycle table says."""
    ERROR = "error"
    """A callback that ends leads to `errorprocessing`, and from there to `unconfigured`."""
    SILENT = "silent"
    """The node hears and acts, but answers and reports nothing."""
    DIE = "die"
    """The process is gone, and what it was at is lost; without this fault it starts anew."""

    @property
    def is_mute(self) -> bool:
        """Tell whether nothing is heard of a node with this fault."""
        return self in NOTICED_AFTER


SLOWDOWN = 20

NOTICED_AFTER: Mapping[Fault, Duration] = MappingProxyType(
    {Fault.SILENT: seconds(3.0), Fault.DIE: seconds(1.0)}
)
"""After how long a node of which nothing is heard is reported as unreachable."""


@dataclass(frozen=True, slots=True)
class NodeSettings:
    """Durations of one simulated node, as of a small real one, and how it starts."""

    configure: Duration = seconds(0.3)
    activate: Duration = seconds(0.2)
    deactivate: Duration = seconds(0.2)
    cleanup: Duration = seconds(0.2)
    shutdown: Duration = seconds(0.2)
    set_parameters: Duration = seconds(0.02)
    process_error: Duration = seconds(0.5)
    """From `errorprocessing` to `unconfigured`."""
    fault: Fault | None = None
    """What is wrong with the node from the start."""
    plain: bool = False
    """Whether the node has parameters only, and no lifecycle."""

    def time_of(self, transition: Transition) -> Duration:
        """Return how long the callback of `transition` takes."""
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
