"""One device in virtual time: its core over simulated nodes, and what its link tells it."""

from itertools import count

from domain.commands import (
    AnswerOrder,
    AskParameters,
    AskTransition,
    Drive,
    LinkCommand,
    NodeCommand,
)
from domain.computers import ComputerName, DeviceState, Incarnation
from domain.devices.lead_view import LeadView
from domain.devices.settings import LeadSettings, OfflineSettings
from domain.devices.sub_model import sub_model
from domain.health.signals import default_signals
from domain.inputs import Input, OrderReceived, SupervisorStatus
from domain.lifecycle import Transition
from domain.outbox import Outputs
from domain.parameters import ParameterValue
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName, StateAndMode
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from service.files.robot_settings import SignalsBlock
from tests.support.core_robot import CoreRobot
from tests.support.models import BASE, actuation_model

FIRST, SECOND = Incarnation("1" * 32), Incarnation("2" * 32)


def offline(after_s: float = 2, *, reactions: bool = False, **targets: str) -> OfflineSettings:
    """Return what a device does when cut off; targets by part, such as `inactive`."""
    wanted = {PartName(part): StateAndMode.parse(text) for part, text in targets.items()}
    return OfflineSettings(seconds(after_s), wanted, reactions)


class DeviceRobot(CoreRobot):
    """A device; what its core tells other computers is kept in `told`."""

    def __init__(
        self,
        does: OfflineSettings | None = None,
        model: SmhModel | None = None,
        nodes: tuple[PartName, ...] = (BASE,),
        settings: SupervisionSettings | None = None,
    ) -> None:
        self.told: list[LinkCommand] = []
        self._numbers = count(1_000)
        lead = LeadSettings(ComputerName("base"), does or OfflineSettings())
        own = sub_model(model or actuation_model(), nodes, default_signals()).model
        signals = SignalsBlock(stale_after_s=0.0).to_domain()
        self.settings = settings or SupervisionSettings(signals, lead=lead)
        super().__init__(own, self.settings)
        self.lose_pose()  # The vehicle is the supervisor's.

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core, and what it asks to the nodes."""
        outputs = self.onboard.handle(given, self.now)
        self.events += outputs.events
        for command in outputs.commands:
            if isinstance(command, NodeCommand | Drive):
                self.commands.append(command)
                self.robot.handle(command, self.now)
            else:
                assert isinstance(command, LinkCommand), "goals stay on board"
                self.told.append(command)
        return outputs

    # --- what the link says ----------------------------------------------------------------------

    def connect(self, incarnation: Incarnation = FIRST) -> None:
        """Let the supervisor be heard."""
        self.give(SupervisorStatus(DeviceState.CONNECTED, incarnation=incarnation))

    def be_late(self) -> None:
        """Let the supervisor be silent for half a second."""
        self.give(SupervisorStatus(DeviceState.LATE, "not heard for 0.5 s", FIRST))

    def lose(self, incarnation: Incarnation = FIRST) -> None:
        """Let the supervisor be lost: its last echo was 1.5 s ago."""
        self.give(SupervisorStatus(DeviceState.LOST, "not heard for 1.5 s", incarnation))

    def order(self, node: str, what: str | dict[str, ParameterValue]) -> int:
        """Let the supervisor have a node do something; return its number of the request."""
        request, name = next(self._numbers), PartName(node)
        if isinstance(what, str):
            command: NodeCommand = AskTransition(request, name, Transition(what))
        else:
            command = AskParameters(request, name, what)
        self.give_order(command)
        return request

    def give_order(self, command: NodeCommand) -> None:
        """Let a command of the supervisor arrive."""
        self.give(OrderReceived(command))
        self.advance(0)

    def carry_out(self, node: str, *orders: str | dict[str, ParameterValue]) -> None:
        """Let the supervisor order several things one after the other, each in its time."""
        for what in orders:
            request = self.order(node, what)
            self.advance(1)
            assert self.answer_to(request).accepted

    def activate(self) -> None:
        """Let the supervisor activate the drive base in its default mode."""
        self.carry_out(BASE, "configure", {"max_speed": 0.1, "controller": "PID"}, "activate")

    # --- what can be seen ------------------------------------------------------------------------

    def answer_to(self, request: int) -> AnswerOrder:
        """Return what the supervisor is told of an order."""
        (found,) = self.answers_to(request)
        return found

    def answers_to(self, request: int) -> list[AnswerOrder]:
        """Return all that the supervisor is told of an order."""
        answers = (told for told in self.told if isinstance(told, AnswerOrder))
        return [answer for answer in answers if answer.request == request]

    @property
    def lead(self) -> LeadView:
        """Return whose word counts."""
        found = self.core.lead()
        assert found is not None
        return found
