"""One run of Pilothouse on one computer: its core, its end of the link, and what it reads and says.

As the shell does it: what the core commands goes to the nodes of this computer or to the link, and
what the link or the nodes tell is an input of the core.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from domain.commands import AskFacts, Command, LinkCommand, NodeCommand
from domain.computers import ComputerName, Incarnation
from domain.errors import PilothouseError
from domain.inputs import Input, NodeAnswer, NodeReport, Restored, TimePassed
from domain.link.device_link import DeviceLink
from domain.link.messages import Message
from domain.link.outputs import LinkOutputs, Sending
from domain.link.supervisor_link import SupervisorLink
from domain.outbox import Outputs
from domain.simulation.nodes import SimulatedNodes
from domain.state_and_mode import PartName
from domain.supervision import Supervision
from domain.timebase import Duration, Instant


@dataclass(frozen=True, slots=True)
class Step:
    """An input of a core, and what followed from it; times are those of its computer."""

    at: Instant
    given: Input
    outputs: Outputs


class Witness(Protocol):
    """Sees all that happens, and judges it."""

    def took(self, process: "Process", step: Step) -> None:
        """See a step of a core."""
        ...

    def heard(self, process: "Process", message: Message, outputs: LinkOutputs) -> None:
        """See what a message led to."""
        ...

    def told(self, process: "Process", inputs: tuple[Input, ...]) -> None:
        """See what a link tells its core, whatever led to it."""
        ...


@dataclass(frozen=True)
class Surroundings:
    """What a process finds on its computer."""

    name: ComputerName
    nodes: SimulatedNodes
    """On the clock of the world; they go on when the process ends."""
    node_names: tuple[PartName, ...]
    mute: set[PartName]
    """Those that say nothing."""
    clock_ahead: Duration
    """Of the clock of the world."""
    send: Callable[[Sending], None]
    witness: Witness


class Process:
    """A core and its end of the link. Times that are given are of the world."""

    def __init__(
        self,
        surroundings: Surroundings,
        core: Supervision,
        link: SupervisorLink | DeviceLink,
        incarnation: Incarnation,
        now: Instant,
    ) -> None:
        self.at = surroundings
        self.core = core
        self.link = link
        self.incarnation = incarnation
        self.started_at = now
        self.steps: list[Step] = []
        """All that happened, for a replay."""
        self.now = now
        """Of the world, when it did something last."""
        self._inputs: deque[Input] = deque()
        self._is_busy = False

    @property
    def name(self) -> ComputerName:
        """Return the name of its computer."""
        return self.at.name

    @property
    def is_supervisor(self) -> bool:
        """Tell whether it supervises."""
        return isinstance(self.link, SupervisorLink)

    @property
    def local_now(self) -> Instant:
        """Return the time on its own clock."""
        return self.now + self.at.clock_ahead

    # --- what it does ----------------------------------------------------------------------------

    def begin(self, restored: Restored, now: Instant) -> None:
        """Begin: what was kept, then what all nodes are in."""
        self.now = now
        self._give(restored)
        for node in self.at.node_names:
            if node in self.at.mute:
                self._node_says(NodeReport(node, reachable=False))
            else:
                self.at.nodes.handle(AskFacts(0, node), now)
        self.advance(now)

    def ask(self, request: Input, now: Instant) -> PilothouseError | None:
        """Hand in what a person asks for; return why it is refused, or None."""
        self.now = now
        try:
            self._take(request)
        except PilothouseError as error:
            self._take(TimePassed())
            return error
        finally:
            self._work()
        return None

    def hear(self, sender: ComputerName, message: Message, now: Instant) -> None:
        """Read a message of another computer."""
        self.now = now
        outputs = self.link.hear(sender, message, self.local_now)
        self.at.witness.heard(self, message, outputs)
        self._follow(outputs)
        self._work()

    def advance(self, now: Instant) -> None:
        """Do all that is due, and take in what the nodes say."""
        self.now = now
        for message in self.at.nodes.advance(now):
            self._node_says(message)
        if self.link.wake_at() <= self.local_now:
            self._follow(self.link.pass_time(self.local_now))
        self._work()
        due = self.core.wake_at()
        if due is not None and due <= self.local_now:
            self._give(TimePassed())

    def wake_at(self) -> Instant | None:
        """Return when something is due, on the clock of the world."""
        link, core, nodes = self.link.wake_at(), self.core.wake_at(), self.at.nodes.wake_at()
        ahead = self.at.clock_ahead
        due = [at - ahead for at in (link, core) if at is not None]
        return min(due if nodes is None else [*due, nodes], default=None)

    # --- between its pieces ----------------------------------------------------------------------

    def _node_says(self, message: NodeReport | NodeAnswer) -> None:
        self._inputs.append(message)
        if isinstance(self.link, DeviceLink):
            self.link.note(message, self.local_now)
        self._work()

    def _give(self, given: Input) -> None:
        self._inputs.append(given)
        self._work()

    def _work(self) -> None:
        """Let the core take what is there, one after the other, and do what it says."""
        if self._is_busy:
            return
        self._is_busy = True
        try:
            while self._inputs:
                self._take(self._inputs.popleft())
        finally:
            self._is_busy = False

    def _take(self, given: Input) -> None:
        step = Step(self.local_now, given, self.core.handle(given, self.local_now))
        self.steps.append(step)
        self.at.witness.took(self, step)
        for command in step.outputs.commands:
            self._carry_out(command)

    def _carry_out(self, command: Command) -> None:
        if isinstance(command, NodeCommand) and command.node in self.at.node_names:
            self.at.nodes.handle(command, self.now)
        elif isinstance(command, NodeCommand | LinkCommand):
            self._follow(self.link.tell(command, self.local_now))

    def _follow(self, outputs: LinkOutputs) -> None:
        if outputs.inputs:
            self.at.witness.told(self, outputs.inputs)
            self._inputs.extend(outputs.inputs)
        for sending in outputs.sendings:
            self.at.send(sending)
