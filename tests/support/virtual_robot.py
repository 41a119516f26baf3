"""The core and the simulated nodes in virtual time, without a loop: what a story needs."""

from collections.abc import Mapping
from typing import Any

from domain.lifecycle import Transition
from domain.messages import (
    ChangeId,
    EmergencyStopRequest,
    Event,
    Input,
    ModeRequest,
    Outputs,
    Reading,
    Readings,
    SignalValue,
    TimePassed,
    TransitionRequest,
)
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.nodes import SimulatedNodes
from domain.snapshot import ChangeView
from domain.supervision import Supervision, SupervisionSettings
from domain.system_model import PartName, SmhModel
from domain.timebase import Instant, seconds

GOOD: Mapping[str, SignalValue] = {
    "battery_level": 1.0,
    "estop": False,
    "gps_accuracy": 100.0,
    "signal_strength": "CONNECTED",
    "temperature": 30.0,
}


class VirtualRobot:
    """A robot whose time moves only when told to; what the core asks is done by simulated nodes."""

    def __init__(
        self,
        model: SmhModel,
        settings: SupervisionSettings | None = None,
        nodes: Mapping[str, NodeSettings] | None = None,
        start: Instant = 0,
    ) -> None:
        self.now = start
        self.model = model
        self.core = Supervision(model, settings or SupervisionSettings(), start)
        by_name = {PartName(name): setting for name, setting in (nodes or {}).items()}
        self.nodes = SimulatedNodes(model, by_name, start)
        self.events: list[Event] = []
        self.advance(0)

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core, and what it asks to the nodes."""
        outputs = self.core.handle(given, self.now)
        self.events += outputs.events
        for command in outputs.commands:
            self.nodes.handle(command, self.now)
        return outputs

    def advance(self, duration_s: float) -> None:
        """Let time pass; everything due happens at its own time, the nodes first."""
        end = self.now + seconds(duration_s)
        while True:
            due = [at for at in (self.nodes.wake_at(), self.core.wake_at()) if at is not None]
            if not due or min(due) > end:
                break
            self.now = max(self.now, min(due))
            for message in self.nodes.advance(self.now):
                self.give(message)
            self._let_core_wake()
        self.now = end

    def _let_core_wake(self) -> None:
        due = self.core.wake_at()
        if due is not None and due <= self.now:
            self.give(TimePassed())

    # --- what an operator does -------------------------------------------------------------------

    def mode(self, part: str, mode: str) -> ChangeId:
        """Ask for a mode."""
        return self._change(ModeRequest(PartName(part), mode))

    def transition(self, part: str, transition: str) -> ChangeId:
        """Ask for a transition."""
        return self._change(TransitionRequest(PartName(part), Transition(transition)))

    def read(self, **values: SignalValue) -> Outputs:
        """Hand in readings."""
        items = tuple(Reading(name, value) for name, value in values.items())
        return self.give(Readings(items, "test"))

    def stop(self, *, engaged: bool = True) -> Outputs:
        """Press or release the emergency stop."""
        return self.give(EmergencyStopRequest(engaged, "test", "operator"))

    def fault(self, node: str, fault: Fault | None) -> None:
        """Let something be wrong with a node."""
        self.nodes.set_fault(PartName(node), fault, self.now)
        self.advance(0)

    def _change(self, request: ModeRequest | TransitionRequest) -> ChangeId:
        change = self.give(request).change
        assert change is not None
        return change

    # --- what an operator sees -------------------------------------------------------------------

    def actual(self, part: str) -> str:
        """Return state and mode of a part as a label."""
        return self.core.part(PartName(part)).actual.state_and_mode.label

    def change(self, identity: str) -> ChangeView:
        """Return a change."""
        return self.core.change(identity)

    def steps(self, identity: str) -> list[tuple[str, str, str]]:
        """Return node, action and status of each step of a change."""
        return [
            (str(step.node), str(step.action), str(step.status))
            for step in self.change(identity).steps
        ]

    def happened(self, kind: str) -> list[Mapping[str, Any]]:
        """Return the data of all events of a kind, in order."""
        return [event.data for event in self.events if event.kind == kind]
