"""Who commands nodes: the core of their own computer, and nobody for it by an order of before."""

from dataclasses import dataclass, field

from domain.commands import ActAlone, AskFacts, AskTransition, NodeCommand
from domain.computers import ComputerName, DeviceState, Incarnation
from domain.inputs import (
    DeviceStatus,
    Input,
    ModeRequest,
    OrderReceived,
    ParametersRequest,
    SupervisorStatus,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.link.messages import Message, NodeOrder
from domain.link.outputs import Sending
from domain.timebase import Instant
from tests.support.network_world.processes import Process, Step

OrderId = tuple[Incarnation, ComputerName, int]
HEARD = (DeviceState.CONNECTED, DeviceState.LATE)
TO_REST = (Transition.DEACTIVATE, Transition.CLEANUP, Transition.SHUTDOWN)


@dataclass
class _Known:
    """What was seen of one process."""

    process: Process
    follows: SupervisorStatus | None = None
    """Of a device."""
    noticed_loss_at: Instant = 0
    """Of a device: when it noticed last that its supervisor was lost."""
    lost: dict[ComputerName, Instant] = field(default_factory=dict)
    """Of a supervisor: when it noticed last that a device was lost."""
    returned: dict[ComputerName, Instant] = field(default_factory=dict)
    carried_out: dict[Incarnation, int] = field(default_factory=dict)
    """Of a device: `seq` of the last order, by who gave it."""
    is_alone: bool = False
    was_asked: bool = False
    """By a person, so that it may command by itself."""
    was_asked_before: bool = False
    """Before the last request."""


class OrderOracle:
    """Invariants 1, 2 and the second half of 5."""

    def __init__(self) -> None:
        self._known: dict[Incarnation, _Known] = {}
        self._sent_at: dict[OrderId, Instant] = {}
        self.counts = {"orders": 0, "alone": 0, "losses": 0, "returns": 0}

    def began(self, process: Process) -> None:
        self._known[process.incarnation] = _Known(process, noticed_loss_at=process.started_at)

    def sent(self, process: Process, sending: Sending) -> None:
        if isinstance(sending.message, NodeOrder):
            order = sending.message
            assert order.incarnation == process.incarnation, "an order in the name of another run"
            number = (order.incarnation, sending.to, order.seq)
            assert number not in self._sent_at, f"{order} has the number of an earlier one"
            self._sent_at[number] = process.now

    def followed_by(self, device: Process) -> SupervisorStatus | None:
        """Return what a device knows of its supervisor."""
        return self._known[device.incarnation].follows

    def asking(self, process: Process, request: Input) -> None:
        """Note that a person asks something."""
        known = self._known[process.incarnation]
        known.was_asked_before = known.was_asked
        if isinstance(request, ModeRequest | TransitionRequest | ParametersRequest):
            known.was_asked = True

    def refused(self, process: Process) -> None:
        """Note that what was asked last was refused, and so gives no reason for anything."""
        known = self._known[process.incarnation]
        known.was_asked = known.was_asked_before

    def told(self, process: Process, inputs: tuple[Input, ...]) -> None:
        known = self._known[process.incarnation]
        for given in inputs:
            match given:
                case SupervisorStatus(state=state):
                    known.follows = given
                    if state not in HEARD:
                        known.noticed_loss_at = process.now
                        self.counts["losses"] += state is DeviceState.LOST
                case DeviceStatus(device=device, state=state):
                    if state in HEARD:
                        if device in known.lost:
                            known.returned[device] = process.now
                            self.counts["returns"] += 1
                    elif known.returned.get(device, 0) >= known.lost.get(device, 0):
                        known.lost[device] = process.now

    def heard(self, process: Process, message: Message, inputs: tuple[Input, ...]) -> None:
        for given in inputs:
            if isinstance(given, OrderReceived):
                assert isinstance(message, NodeOrder), f"{given} came of {message}"
                assert given.command == message.command, f"{given} came of {message}"
                self._judge(process, message)

    def _judge(self, process: Process, order: NodeOrder) -> None:
        """Judge an order that a device carries out."""
        known = self._known[process.incarnation]
        sent_at = self._sent_at[order.incarnation, process.name, order.seq]
        follows = known.follows
        self.counts["orders"] += 1
        assert order.command.node in process.at.node_names, f"{order} is for another's node"
        assert follows is not None, f"{order} before any supervisor was followed"
        assert follows.state in HEARD, f"{order} while the supervisor is {follows.state}"
        assert follows.incarnation == order.incarnation, f"{order} is not of the one followed"
        assert sent_at >= known.noticed_loss_at, (
            f"{order} was sent before the device noticed the loss"
        )
        before = known.carried_out.get(order.incarnation, -1)
        assert order.seq > before, f"{order} after number {before}"
        known.carried_out[order.incarnation] = order.seq
        giver = self._known[order.incarnation]
        lost = giver.lost.get(process.name)
        if lost is not None and giver.returned.get(process.name, 0) > lost:
            assert sent_at >= lost, f"{order} was sent before the supervisor noticed the loss"

    def took(self, process: Process, step: Step) -> None:
        known = self._known[process.incarnation]
        for command in step.outputs.commands:
            if isinstance(command, ActAlone):
                assert not command.autonomous or known.follows is not None, "alone from the start"
                known.is_alone = command.autonomous
                self.counts["alone"] += command.autonomous
            elif isinstance(command, NodeCommand) and not isinstance(command, AskFacts):
                self._judge_command(process, known, step, command)

    def _judge_command(
        self, process: Process, known: _Known, step: Step, command: NodeCommand
    ) -> None:
        """Judge why a core commands a node."""
        if process.is_supervisor:
            assert known.was_asked, f"{command} though nobody asked since the start"
            return
        if isinstance(step.given, OrderReceived):
            asked = step.given.command
            asks_the_same = type(command) is type(asked) and command.node == asked.node
            if asks_the_same:
                return
        if known.is_alone:
            return
        is_to_rest = isinstance(command, AskTransition) and command.transition in TO_REST
        assert known.was_asked, f"{command} by a device that nobody asked and that is not alone"
        assert is_to_rest, f"{command} by a device whose supervisor commands"
