"""A robot of several computers, and the network between them, in one virtual time."""

from collections.abc import Callable
from functools import partial
from itertools import permutations
from random import Random

from domain.computers import SUPERVISOR, ComputerName, Incarnation
from domain.errors import PilothouseError
from domain.inputs import Input
from domain.link.messages import Beat, Message
from domain.link.outputs import LinkOutputs, Sending
from domain.parts.system_model import SmhModel
from domain.simulation.network import SimulatedNetwork
from domain.state_and_mode import PartName
from domain.timebase import Instant, seconds, to_seconds
from service.link.wire import decode, encode
from tests.support.network_world.computers import Computer
from tests.support.network_world.cores import make_core, make_link
from tests.support.network_world.happenings import (
    Ask,
    Crash,
    Happening,
    Newcomer,
    NewcomerEnds,
    NodeFault,
    Sleep,
    Start,
    Store,
    WireChanges,
)
from tests.support.network_world.oracles import Oracles
from tests.support.network_world.processes import Process, Step, Surroundings
from tests.support.network_world.robots import MODEL
from tests.support.network_world.stories import Story, newcomer_of

CLOCKS_APART_S = 300.0
MOST_STEPS = 1_000
"""At one instant."""


class World:
    """What a story happens to."""

    def __init__(self, story: Story) -> None:
        """Begin with nothing running."""
        self.story = story
        self.now: Instant = 0
        self._steps_now = 0
        self.rng = Random(f"world {story.seed}")
        self.network: SimulatedNetwork[Message] = SimulatedNetwork(story.seed)
        self.oracles = Oracles(self)
        self.reads_first = self.rng.random() < 0.5
        """Whether a process that wakes up reads what came before it looks at the clock."""
        self.by_wire = story.seed % 4 == 0
        """Whether messages are bytes on their way."""
        self.computers: dict[ComputerName, Computer] = {}
        """By endpoint."""
        self._add(SUPERVISOR, SUPERVISOR, story.arrangement.local_nodes)
        for name, device in story.arrangement.devices.items():
            self._add(name, name, device.nodes)
        self._left = list(reversed(story.happenings))

    def _add(
        self, name: ComputerName, endpoint: ComputerName, nodes: tuple[PartName, ...]
    ) -> Computer:
        ahead = seconds(self.rng.uniform(0.0, CLOCKS_APART_S))
        model = SmhModel({node: MODEL.nodes[node] for node in nodes}, {})
        made = self.computers[endpoint] = Computer(name, endpoint, model, nodes, ahead)
        self._set_wires(made)
        return made

    def _set_wires(self, computer: Computer) -> None:
        for other in self.computers.values():
            if other is not computer:
                for one, another in permutations((computer.endpoint, other.endpoint)):
                    self.network.set_wire(self.now, one, another, self.story.wire)

    # --- what is there ---------------------------------------------------------------------------

    @property
    def running(self) -> list[tuple[Computer, Process]]:
        """Return the computers that have a process."""
        found = self.computers.values()
        return [(computer, computer.process) for computer in found if computer.process is not None]

    def process(self, name: ComputerName) -> Process:
        """Return the process of a computer, which must run."""
        process = self.computers[name].process
        assert process is not None, f"{name} does not run"
        return process

    @property
    def supervisor(self) -> Process:
        """Return the process that supervises, which must run."""
        return self.process(SUPERVISOR)

    @property
    def devices(self) -> list[Process]:
        """Return the processes of the devices, which must run."""
        return [self.process(name) for name in self.story.arrangement.devices]

    def owner(self, node: PartName) -> Computer:
        """Return the computer of a node."""
        return self.computers[self.story.arrangement.owner_of(node) or SUPERVISOR]

    # --- time ------------------------------------------------------------------------------------

    def run(self, until_s: float) -> None:
        """Let all happen up to a time, each at its own."""
        end = seconds(until_s)
        while (due := self._due()) is not None and due <= end:
            self._note_time(due)
            self._happen()
            for arrival in self.network.arrivals(due):
                self._deliver(arrival.sender, arrival.to, arrival.message)
            for computer in list(self.computers.values()):
                self._let_act(computer)
            self.oracles.look()
        self.now = end

    def _note_time(self, due: Instant) -> None:
        assert due >= self.now, "time went back"
        self._steps_now = self._steps_now + 1 if due == self.now else 0
        assert self._steps_now < MOST_STEPS, "time stands still"
        self.now = due

    def wait(self, duration_s: float) -> None:
        """Let time pass."""
        self.run(to_seconds(self.now) + duration_s)

    def wait_until(self, is_so: Callable[[], bool], most_s: float) -> None:
        """Let time pass until something is so, but not for ever."""
        end = to_seconds(self.now) + most_s
        while not is_so() and to_seconds(self.now) < end:
            self.wait(0.25)

    def _due(self) -> Instant | None:
        due = [computer.wake_at() for computer in self.computers.values()]
        due += [self.network.wake_at(), seconds(self._left[-1][0]) if self._left else None]
        return min((at for at in due if at is not None), default=None)

    def _happen(self) -> None:
        while self._left and seconds(self._left[-1][0]) <= self.now:
            self.befall(self._left.pop()[1])

    def _let_act(self, computer: Computer) -> None:
        due = computer.wake_at()
        if due is None or due > self.now:
            return
        computer.has_news = True
        process = computer.process
        if process is None:
            computer.nodes.advance(self.now)
            return
        if computer.was_asleep:
            computer.was_asleep = False
            self.oracles.lease.awoke(process, self.now)
            if not self.reads_first:
                process.advance(self.now)
        while computer.unread:
            self._read(process, *computer.unread.popleft())
        process.advance(self.now)

    # --- messages --------------------------------------------------------------------------------

    def _send(self, computer: Computer, sending: Sending) -> None:
        process, message = computer.process, sending.message
        if process is None:
            return  # It was killed by what it said.
        self.oracles.sent(process, sending)
        if self.by_wire:
            message = decode(encode(message))
        for other in self.computers.values():
            if other.name == sending.to and other is not computer:
                self.network.send(
                    self.now,
                    computer.endpoint,
                    other.endpoint,
                    message,
                    may_be_lost=isinstance(message, Beat),
                )

    def _deliver(self, sender: ComputerName, to: ComputerName, message: Message) -> None:
        computer = self.computers.get(to)
        if computer is None or computer.process is None or sender not in self.computers:
            return
        name = self.computers[sender].name
        if computer.was_asleep:
            computer.unread.append((name, message))
        else:
            computer.has_news = True
            self._read(computer.process, name, message)

    def _read(self, process: Process, sender: ComputerName, message: Message) -> None:
        process.hear(sender, message, self.now)
        self.oracles.read(process, message)

    # --- what happens ----------------------------------------------------------------------------

    def befall(self, happening: Happening) -> None:
        """Let something happen now."""
        for computer in self.computers.values():
            computer.has_news = True
            computer.disk.back_up()
        match happening:
            case WireChanges(sender, to, wire):
                self.network.set_wire(self.now, sender, to, wire)
            case Crash(name):
                self._crash(self.computers[name])
            case Start(name, store):
                self._start(self.computers[name], store)
            case Sleep(name, for_s):
                self.computers[name].fall_asleep(self.now + seconds(for_s))
            case Ask(name, request):
                self.ask(name, request)
            case NodeFault(node, fault):
                self.owner(node).set_fault(node, fault, self.now)
            case Newcomer(name):
                self._begin_newcomer(name)
            case NewcomerEnds(name):
                self._end_newcomer(name)

    def ask(self, name: ComputerName, request: Input) -> PilothouseError | None:
        """Ask something at a computer; return why it is refused, or None."""
        computer = self.computers.get(name)
        if computer is None or computer.process is None or computer.asleep_until > self.now:
            return PilothouseError("nobody answers")
        process = computer.process
        computer.has_news = True
        with self.oracles.asked(process, request) as answer:
            answer.refusal = process.ask(request, self.now)
        return answer.refusal

    def make_whole(self) -> None:
        """Mend all that is wrong, and start all that does not run."""
        for name in (SUPERVISOR, *self.story.arrangement.devices):
            self._end_newcomer(name)
        for computer in self.computers.values():
            self._set_wires(computer)
            computer.has_news = True
            computer.asleep_until = min(computer.asleep_until, self.now)
            for node in computer.node_names:
                computer.mend(node, self.now)
            self._start(computer, Store.KEPT)
        # What was sent before, and must not be lost, keeps what comes after it waiting.
        self.run(to_seconds(self.network.empty_at() or self.now))

    def _crash(self, computer: Computer) -> None:
        if computer.process is not None:
            self.oracles.stops.ended(computer.process, computer.endpoint)
        computer.process = None
        computer.unread.clear()
        computer.asleep_until = min(computer.asleep_until, self.now)
        computer.was_asleep = False
        self.network.forget(computer.endpoint)

    def _start(self, computer: Computer, store: Store) -> None:
        if computer.process is not None:
            return
        incarnation = Incarnation(self._new_id())
        restored = computer.disk.open(store, incarnation, self.rng)
        surroundings = Surroundings(
            computer.name,
            computer.nodes,
            computer.node_names,
            computer.mute,
            computer.clock_ahead,
            partial(self._send, computer),
            _Witness(self, computer),
        )
        local = self.now + computer.clock_ahead
        core = make_core(computer.name, self.story.arrangement, local)
        link = make_link(computer.name, self.story.arrangement, incarnation, self._new_id, local)
        process = Process(surroundings, core, link, incarnation, self.now)
        computer.process = process
        computer.nodes.advance(self.now)
        self.oracles.began(process)
        process.begin(restored, self.now)
        self.oracles.stops.restored(process, computer.endpoint)

    def _new_id(self) -> str:
        return f"{self.rng.getrandbits(128):032x}"

    def _begin_newcomer(self, name: ComputerName) -> None:
        if newcomer_of(name) not in self.computers:
            nodes = self.computers[name].node_names
            self._start(self._add(name, newcomer_of(name), nodes), Store.LOST)

    def _end_newcomer(self, name: ComputerName) -> None:
        computer = self.computers.get(newcomer_of(name))
        if computer is not None:
            self._crash(computer)
            self.oracles.stops.gone(computer.endpoint)
            del self.computers[computer.endpoint]


class _Witness:
    """Passes on what is seen of a process, and keeps what must survive it."""

    def __init__(self, world: World, computer: Computer) -> None:
        self._oracles = world.oracles
        self._disk = computer.disk

    def took(self, process: Process, step: Step) -> None:
        self._disk.keep(step.outputs)
        self._oracles.took(process, step)

    def heard(self, process: Process, message: Message, outputs: LinkOutputs) -> None:
        self._oracles.heard(process, message, outputs)

    def told(self, process: Process, inputs: tuple[Input, ...]) -> None:
        self._oracles.told(process, inputs)
