"""The facts about one node, each kept apart from the others.

No fact is derived from another one: parameters that match a mode do not make a node active.
"""

from dataclasses import dataclass, field

from domain.findings import Blocker
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parameters import ParameterValue, same_value
from domain.state_and_mode import ModeName
from domain.timebase import Instant


@dataclass(slots=True)
class NodeFacts:
    """Latest reported facts of a node; None: never reported."""

    state: LifecycleState | None = None
    mode: ModeName | None = None
    parameters: dict[str, ParameterValue] = field(default_factory=dict)
    reachable: bool | None = None
    has_lifecycle: bool = True
    state_since: Instant | None = None
    """Since when the node is in its known state; None: unknown."""
    cut_off: Blocker | None = None
    """Why nothing can be heard of it, whatever it does: its device is not connected."""

    def take(self, report: NodeReport, now: Instant | None = None) -> bool:
        """Update the facts from a report; return whether any of them changed.

        A node that leaves `active` loses its reported mode, as in system_modes.

        Args:
            report: From the node.
            now: When it arrived; None: not relevant.
        """
        known = self.known_state
        before = (self.state, self.mode, self.reachable, self.has_lifecycle)
        if report.reachable is not None:
            self.reachable = report.reachable
        elif self.reachable is None:
            self.reachable = True
        if report.has_lifecycle is not None:
            self.has_lifecycle = report.has_lifecycle
        if report.state is not None:
            self.state = report.state
            if report.state is not LifecycleState.ACTIVE:
                self.mode = None
        if report.mode is not None:
            self.mode = report.mode
        if self.known_state is not known or self.state_since is None:
            self.state_since = now
        changed = before != (self.state, self.mode, self.reachable, self.has_lifecycle)
        for name, value in (report.parameters or {}).items():
            if name not in self.parameters or not same_value(self.parameters[name], value):
                self.parameters[name] = value
                changed = True
        return changed

    @property
    def known_state(self) -> LifecycleState:
        """Return the current state: `unknown` if the node is unreachable or never reported.

        A plain node has no lifecycle; it counts as active while it is reachable.
        """
        if not self.reachable:
            return LifecycleState.UNKNOWN
        if not self.has_lifecycle:
            return LifecycleState.ACTIVE
        return self.state or LifecycleState.UNKNOWN

    @property
    def why_unknown(self) -> str:
        """Return why the state is unknown, as a phrase that follows the node's name."""
        is_lost = self.reachable is False
        words = "is unreachable" if is_lost else "has never reported a state"
        return words if self.cut_off is None else f"{words}: {self.cut_off.message}"
