"""Events of nodes and systems."""

from dataclasses import dataclass, field

from domain.events.event import Event, because
from domain.lifecycle import LifecycleState
from domain.parameters import Parameters
from domain.state_and_mode import ModeName, PartName, StateAndMode


@dataclass(frozen=True, slots=True)
class NodeReported(Event):
    """A node, or the backend on its behalf, reports its state, mode, parameters or presence."""

    kind = "node.reported"
    is_input = True
    is_notable = False
    optional = frozenset({"state", "mode", "parameters", "reachable"})

    node: PartName
    state: LifecycleState | None = None
    mode: ModeName | None = None
    parameters: Parameters | None = None
    reachable: bool | None = None

    def _words(self) -> str:
        said = [str(value) for value in (self.state, self.mode) if value is not None]
        if self.parameters:
            said.append(f"parameters {', '.join(self.parameters)}")
        if self.reachable is False:
            said.append("unreachable")
        return f"{self.node} reports {', '.join(said) or 'that it is reachable'}"


@dataclass(frozen=True, slots=True)
class CheckpointReached(Event):
    """A node reports that its program passes a checkpoint."""

    kind = "checkpoint.reached"
    is_input = True
    is_notable = False

    node: PartName
    checkpoint: str

    def _words(self) -> str:
        return f"{self.node} reached {self.checkpoint}"


@dataclass(frozen=True, slots=True)
class NodeReachable(Event):
    """A node is reachable, for the first time or again."""

    kind = "node.reachable"
    hidden = frozenset({"with_device"})

    node: PartName
    with_device: bool = field(default=False, kw_only=True)
    """Its device is about to be connected."""

    def _words(self) -> str:
        return f"{self.node} is reachable"

    @property
    def notable(self) -> bool:
        """Tell whether no event of its device says so as well."""
        return not self.with_device


@dataclass(frozen=True, slots=True)
class NodeUnreachable(Event):
    """A node is no longer reachable."""

    kind = "node.unreachable"
    hidden = frozenset({"with_device"})

    node: PartName
    with_device: bool = field(default=False, kw_only=True)
    """Its device is not connected."""

    def _words(self) -> str:
        return f"{self.node} is unreachable"

    @property
    def notable(self) -> bool:
        """Tell whether no event of its device says so as well."""
        return not self.with_device


@dataclass(frozen=True, slots=True)
class PartActualChanged(Event):
    """A part entered another state or mode."""

    kind = "part.actual_changed"
    hidden = frozenset({"of_system"})

    part: PartName
    actual: StateAndMode
    was: StateAndMode
    reason: str | None
    of_system: bool = field(default=False, kw_only=True)
    """Whether the part is a system; changes of single nodes are detail."""

    def _words(self) -> str:
        return f"{self.part}: {self.was.label} -> {self.actual.label}"

    @property
    def notable(self) -> bool:
        """Tell whether the part is a system."""
        return self.of_system


@dataclass(frozen=True, slots=True)
class _Deviation(Event):
    """A part and its target, at one moment."""

    is_notable = False

    part: PartName
    target: StateAndMode | None
    actual: StateAndMode
    reason: str | None

    def _words(self) -> str:
        wanted = f", target {self.target.label}" if self.target else ""
        return because(f"{self.part} is {self.actual.label}{wanted}", self.reason)


@dataclass(frozen=True, slots=True)
class DeviationBegan(_Deviation):
    """A part, or one of its parts, is no longer in its target state and mode."""

    kind = "part.deviation_began"


@dataclass(frozen=True, slots=True)
class DeviationEnded(_Deviation):
    """A part and all its parts are in their target states and modes again, if they have any."""

    kind = "part.deviation_ended"
