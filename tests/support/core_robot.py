"""The core and the simulated nodes in virtual time, without a loop: what a story needs."""

from collections.abc import Mapping
from typing import Any

from domain.commands import Command, Drive, LinkCommand, NodeCommand
from domain.events.event import RecordedEvent
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, Input, TimePassed
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.robot import SimulatedRobot
from domain.simulation.vehicle_settings import VehicleSettings
from domain.snapshot import ChangeView, TaskView
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from domain.timebase import Instant, seconds
from tests.support.live_robot import make_onboard
from tests.support.operator_verbs import OperatorVerbs, change_of


class CoreRobot(OperatorVerbs[Outputs, ChangeId, None]):
    """A robot whose time moves only when told to; what the core asks is done by simulated nodes."""

    def __init__(
        self,
        model: SmhModel,
        settings: SupervisionSettings | None = None,
        nodes: Mapping[str, NodeSettings] | None = None,
        start: Instant = 0,
        vehicle: VehicleSettings | None = None,
    ) -> None:
        self.now = start
        self.model = model
        self.onboard = self.make(model, start, settings)
        self.core = self.onboard.core
        by_name = {PartName(name): setting for name, setting in (nodes or {}).items()}
        self.robot = SimulatedRobot(model, start, by_name, vehicle)
        self.nodes = self.robot.nodes
        self.events: list[RecordedEvent] = []
        self.commands: list[Command] = []
        """What was sent to nodes and vehicle."""
        self.told_others: list[Command] = []
        """What other computers of the robot were told."""
        self.advance(0)

    def make(
        self, model: SmhModel, start: Instant, settings: SupervisionSettings | None
    ) -> Onboard:
        """Return the core."""
        return make_onboard(model, start, settings)

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core, and what it asks to the nodes."""
        outputs = self.onboard.handle(given, self.now)
        self.events += outputs.events
        for command in outputs.commands:
            if isinstance(command, LinkCommand):
                self.told_others.append(command)
                continue
            assert isinstance(command, NodeCommand | Drive), "goals stay on board"
            self.commands.append(command)
            self.robot.handle(command, self.now)
        return outputs

    def begin(self, request: ChangeRequest) -> ChangeId:
        """Ask for a change and return it."""
        return change_of(self.give(request))

    def advance(self, duration_s: float) -> None:
        """Let time pass; everything due happens at its own time, the robot's part first."""
        end = self.now + seconds(duration_s)
        while True:
            due = [at for at in (self.robot.wake_at(), self.onboard.wake_at()) if at is not None]
            if min(due) > end:
                break
            self.now = max(self.now, min(due))
            for message in self.robot.advance(self.now):
                self.give(message)
            self._let_core_wake()
        self.now = end

    def _let_core_wake(self) -> None:
        due = self.onboard.wake_at()
        if due is not None and due <= self.now:
            self.give(TimePassed())

    # --- what goes wrong -------------------------------------------------------------------------

    def lose_pose(self, *, lost: bool = True) -> None:
        """Let the vehicle stop telling where it is, or tell it again."""
        self.robot.vehicle.set_reporting(not lost, self.now)
        self.advance(0)

    def fault(self, node: str, fault: Fault | None) -> None:
        """Let something be wrong with a node."""
        self.nodes.set_fault(PartName(node), fault, self.now)
        self.advance(0)

    # --- what an operator sees -------------------------------------------------------------------

    def actual(self, part: str) -> str:
        """Return state and mode of a part as a label."""
        return self.core.part(PartName(part)).actual.state_and_mode.label

    def change(self, identity: str) -> ChangeView:
        """Return a change."""
        return self.core.change(identity)

    @property
    def task(self) -> TaskView:
        """Return the task that was served last."""
        return next(iter(self.core.driving.tasks()))

    def steps(self, identity: str) -> list[tuple[str, str, str]]:
        """Return node, action and status of each step of a change."""
        return [
            (str(step.node), str(step.action), str(step.status))
            for step in self.change(identity).steps
        ]

    def happened(self, kind: str) -> list[Mapping[str, Any]]:
        """Return the data of all events of a kind, in order."""
        return [event.data for event in self.events if event.kind == kind]
