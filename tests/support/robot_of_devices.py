"""The core of a supervisor whose nodes are on two devices; what their links say is given by hand.

So one story can say exactly what arrives, and in which order.
"""

from collections.abc import Mapping

from domain.commands import AskFacts, AskParameters, AskTransition, Command, NodeCommand
from domain.computers import ComputerName, DeviceState, Incarnation, Session
from domain.devices.device_view import DeviceView
from domain.devices.settings import DeviceSettings
from domain.errors import PilothouseError
from domain.events.event import RecordedEvent
from domain.inputs import DeviceStatus, Input, NodeAnswer, NodeReport, Restored, TimePassed
from domain.kept import Keeping
from domain.lifecycle import LifecycleState
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.snapshot import ErrorKey, ErrorView
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Instant, seconds
from tests.support.models import ARM, BASE, actuation_model

ARM_COMPUTER, BASE_COMPUTER = ComputerName("arm"), ComputerName("base")
DEVICES: Mapping[ComputerName, DeviceSettings] = {
    BASE_COMPUTER: DeviceSettings(BASE_COMPUTER, (BASE,)),
    ARM_COMPUTER: DeviceSettings(ARM_COMPUTER, (ARM,)),
}
"""The base and the arm of the robot of D4.8 have a computer each."""

SILENT = "device arm has not been heard for 1.5 s"


class RobotOfDevices:
    """A supervisor, and what it is told."""

    def __init__(
        self, model: SmhModel | None = None, settings: SupervisionSettings | None = None
    ) -> None:
        """Begin without a device that was heard.

        Args:
            model: Of the robot; None: that of D4.8.
            settings: Of the core; None: the two devices, and readings that hold for ever.
        """
        self.model = model or actuation_model()
        self.settings = settings or SupervisionSettings(devices=DEVICES, peers=tuple(DEVICES))
        self.now: Instant = 0
        self.core = Supervision(self.model, self.settings, self.now)
        self.events: list[RecordedEvent] = []
        self.commands: list[Command] = []
        self.kept: dict[tuple[type, str], Keeping] = {}
        self.record: list[tuple[Instant, Input, Outputs | None]] = []
        """Each input, and what followed; None: it was refused."""

    # --- what happens ----------------------------------------------------------------------------

    def give(self, given: Input) -> Outputs:
        """Hand in one input."""
        try:
            outputs = self.core.handle(given, self.now)
        except PilothouseError:
            self.record.append((self.now, given, None))
            raise
        self.record.append((self.now, given, outputs))
        self.events += outputs.events
        self.commands += outputs.commands
        self.kept.update({(keeping.kind, keeping.name): keeping for keeping in outputs.kept})
        return outputs

    def advance(self, duration_s: float) -> "RobotOfDevices":
        """Let time pass."""
        end = self.now + seconds(duration_s)
        while (due := self.core.wake_at()) is not None and due <= end:
            self.now = max(self.now, due)
            self.give(TimePassed())
        self.now = end
        return self

    def says(
        self,
        state: DeviceState,
        device: ComputerName = ARM_COMPUTER,
        reason: str = "",
        *,
        run: int = 1,
        autonomous: bool = False,
        refused: str = "",
    ) -> Outputs:
        """Let the link say how the connection to a device is."""
        process, session = Incarnation(f"{run:032x}"), Session(f"{run + 100:032x}")
        known = None if state is DeviceState.NEVER_SEEN else process
        status = DeviceStatus(
            device, state, reason, known, session, "0.9.1", autonomous=autonomous, refused=refused
        )
        return self.give(status)

    def hears(
        self, node: PartName, state: str = "unconfigured", reachable: bool = True
    ) -> "RobotOfDevices":
        """Let the device of a node tell of it."""
        known = LifecycleState(state) if reachable else None
        self.give(NodeReport(node, known, reachable=reachable))
        return self

    def connect(
        self, device: ComputerName = ARM_COMPUTER, state: str = "unconfigured", run: int = 1
    ) -> "RobotOfDevices":
        """Let a device be connected: its nodes are told first."""
        for node in self.settings.devices[device].nodes:
            self.hears(node, state)
        self.says(DeviceState.CONNECTED, device, run=run)
        return self

    def connect_all(self, state: str = "unconfigured") -> "RobotOfDevices":
        """Let all devices be connected."""
        for device in self.settings.devices:
            self.connect(device, state)
        return self

    def lose(self, device: ComputerName = ARM_COMPUTER, reason: str = SILENT) -> "RobotOfDevices":
        """Let a device be lost, and so its nodes."""
        self.says(DeviceState.LOST, device, reason)
        for node in self.settings.devices[device].nodes:
            self.hears(node, reachable=False)
        return self

    def obey(self) -> "RobotOfDevices":
        """Let nodes do what they were asked since, until nothing more is asked."""
        while commands := [c for c in self.commands if isinstance(c, NodeCommand)]:
            self.commands.clear()
            for command in commands:
                self._obey(command)
        return self

    def _obey(self, command: NodeCommand) -> None:
        node, facts = command.node, None
        if isinstance(command, AskFacts):
            return
        self.give(NodeAnswer(command.request, node, accepted=True))
        if isinstance(command, AskTransition):
            facts = NodeReport(node, command.transition.goal, reachable=True)
        if isinstance(command, AskParameters):
            facts = NodeReport(node, parameters=command.values)
        assert facts is not None
        self.give(facts)

    def restart(self) -> "RobotOfDevices":
        """Let the supervisor start anew with what was kept; it has heard of nobody."""
        self.core = Supervision(self.model, self.settings, self.now)
        kept = tuple(each.value for each in self.kept.values() if each.value is not None)
        self.record.clear()
        self.commands.clear()
        self.give(Restored(kept, boot=2))
        return self

    # --- what can be seen ------------------------------------------------------------------------

    def device(self, name: ComputerName = ARM_COMPUTER) -> DeviceView:
        """Return a device."""
        return self.core.devices()[name]

    def error(self, name: str) -> ErrorView:
        """Return an error by its name, such as `arm.LOST`."""
        part, _, error = name.rpartition(".")
        return self.core.error(ErrorKey(PartName(part), error))

    @property
    def announced(self) -> list[str]:
        """Return the errors of parts and devices that no other one explains, in order."""
        views = self.core.open_errors().values()
        roots = (view for view in views if view.state.is_on and view.is_root)
        return [view.key.name for view in roots if view.key.part is not None]

    def happened(self, kind: str) -> list[str]:
        """Return what events of a kind say, such as `device.*`."""
        prefix = kind.removesuffix("*")
        return [each.event.words for each in self.events if each.kind.startswith(prefix)]

    @property
    def short_list(self) -> list[str]:
        """Return what an operator reads in a short list of events."""
        return [each.event.words for each in self.events if each.event.notable]
