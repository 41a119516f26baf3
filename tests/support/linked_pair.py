"""A supervisor and devices over a small network in virtual time: machines alone, without cores."""

import heapq
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import count
from typing import NamedTuple

from domain.commands import AskTransition, LinkCommand, NodeCommand, TellStops
from domain.computers import SUPERVISOR, ComputerName, Incarnation, PeerStop, StopId
from domain.inputs import (
    DeviceStatus,
    Input,
    NodeAnswer,
    NodeReport,
    OrderReceived,
    PeerStops,
    SupervisorStatus,
)
from domain.lifecycle import LifecycleState, Transition
from domain.link.device_link import DeviceLink
from domain.link.messages import Beat, Message, NodeOrder, Terms, Told
from domain.link.outputs import LinkOutputs
from domain.link.settings import Owned
from domain.link.supervisor_link import SupervisorLink
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant, seconds

BASE, ARM = ComputerName("base"), ComputerName("arm")
DRIVE, GRIPPER = PartName("drive_base"), PartName("manipulator")
OWNED: Mapping[ComputerName, Owned] = {
    BASE: Owned((DRIVE,), ("motor_temperature",)),
    ARM: Owned((GRIPPER,)),
}
TERMS = Terms(model="m", ownership="o", version="1.2.0")
UNCONFIGURED = NodeReport(DRIVE, LifecycleState.UNCONFIGURED, reachable=True)


class Process:
    """One process of a computer: its machine, and all that its core was given."""

    def __init__(self, name: ComputerName, machine: SupervisorLink | DeviceLink) -> None:
        """Begin; nothing was given yet."""
        self.name = name
        self.machine = machine
        self.inputs: list[tuple[Instant, Input]] = []
        self.is_running = True
        self.is_hidden = False
        """It hears, and is not heard."""

    @property
    def statuses(self) -> list[tuple[float, str]]:
        """Return when the connection changed, in s, and to what: of a supervisor, to all."""
        return [
            (at / 1e9, given.state)
            for at, given in self.inputs
            if isinstance(given, DeviceStatus | SupervisorStatus)
        ]

    def status(self, of: ComputerName = BASE) -> DeviceStatus | SupervisorStatus:
        """Return how the connection is: of a supervisor, that to a device."""
        for _, given in reversed(self.inputs):
            if isinstance(given, SupervisorStatus):
                return given
            if isinstance(given, DeviceStatus) and given.device == of:
                return given
        raise AssertionError("no status was given")

    @property
    def orders(self) -> list[NodeCommand]:
        """Return the commands that are carried out here."""
        return [given.command for _, given in self.inputs if isinstance(given, OrderReceived)]

    @property
    def answers(self) -> list[NodeAnswer]:
        """Return the answers that came to commands."""
        return [given for _, given in self.inputs if isinstance(given, NodeAnswer)]

    def reports(self, node: PartName = DRIVE) -> list[tuple[float, NodeReport]]:
        """Return the reports of a node, and when each was given, in s."""
        return [
            (at / 1e9, given)
            for at, given in self.inputs
            if isinstance(given, NodeReport) and given.node == node
        ]

    def stops_of(self, computer: ComputerName) -> set[str]:
        """Return the stops of another computer that are engaged, as the core knows."""
        engaged: set[str] = set()
        for _, given in self.inputs:
            if isinstance(given, PeerStops) and given.computer == computer:
                told = {str(stop.id) for stop in given.stops}
                engaged = told if given.ended is None else (engaged | told) - set(given.ended)
        return engaged


class _Flight(NamedTuple):
    at: Instant
    number: int
    sender: ComputerName
    to: ComputerName
    message: Message


@dataclass
class Way:
    """How messages go from one computer to another."""

    delay: Duration = seconds(0.001)
    is_cut: bool = False
    keeps: bool = False
    """While it is cut: messages arrive once it is whole again."""
    loses_beats: bool = False
    """Only commands and reports arrive."""
    order_delay: Duration = 0
    """How much longer commands and reports take than beats."""
    doubles: bool = False
    """Each message arrives a second time, 50 ms later."""
    kept: list[Message] = field(default_factory=list)


class LinkedRobot:
    """Processes of several computers; whoever has a name hears what goes to that name."""

    def __init__(self, devices: Iterable[ComputerName] = (BASE,), terms: Terms = TERMS) -> None:
        """Start a supervisor and devices, at time 0."""
        self.now: Instant = 0
        self.processes: list[Process] = []
        self.ways: dict[tuple[ComputerName, ComputerName], Way] = {}
        self.sent: list[tuple[Instant, ComputerName, Message]] = []
        self._terms = terms
        self._devices = tuple(devices)
        self._flights: list[_Flight] = []
        self._ids = count(1)
        self._requests = count(1)
        self.supervisor = self.start(SUPERVISOR)
        self.devices = {name: self.start(name) for name in self._devices}

    @classmethod
    def out_of_step(cls) -> "LinkedRobot":
        """Return a robot at 1 s whose device sends its beats 50 ms after those of the supervisor.

        So one end notices a loss before the other.
        """
        robot = cls()
        robot.kill(robot.base)
        robot.run(0.05)
        robot.devices[BASE] = robot.start(BASE)
        robot.run(0.95)
        return robot

    @property
    def base(self) -> Process:
        """Return the device of most stories."""
        return self.devices[BASE]

    def new_id(self) -> str:
        """Return an id that was not used before."""
        return f"{next(self._ids):032x}"

    def start(self, name: ComputerName, terms: Terms | None = None) -> Process:
        """Start a process of a computer; there may be another one."""
        terms, own = terms or self._terms, Incarnation(self.new_id())
        machine: SupervisorLink | DeviceLink
        if name == SUPERVISOR:
            owned = {device: OWNED[device] for device in self._devices}
            machine = SupervisorLink(terms, owned, own, self.now)
        else:
            machine = DeviceLink(
                name, terms, self._devices, OWNED[name], own, self.new_id, self.now
            )
        process = Process(name, machine)
        self.processes.append(process)
        if name == BASE:
            self.note(UNCONFIGURED, process)
        if name == ARM:
            self.note(NodeReport(GRIPPER, LifecycleState.ACTIVE, reachable=True), process)
        return process

    def kill(self, process: Process) -> None:
        """End a process."""
        process.is_running = False

    def hide(self, process: Process) -> None:
        """Let nothing that a process sends arrive any more; it hears all."""
        process.is_hidden = True

    def show(self, process: Process) -> None:
        """Let arrive again what a process sends."""
        process.is_hidden = False

    def way(self, sender: ComputerName, to: ComputerName) -> Way:
        """Return how messages go from one computer to another."""
        return self.ways.setdefault((sender, to), Way())

    def cut(self, one: ComputerName, other: ComputerName, *, keeps: bool = False) -> None:
        """Cut both ways between two computers."""
        for way in (self.way(one, other), self.way(other, one)):
            way.is_cut, way.keeps = True, keeps

    def mend(self, one: ComputerName, other: ComputerName) -> None:
        """Make both ways between two computers whole; what was kept arrives now."""
        self.mend_one(one, other)
        self.mend_one(other, one)

    def mend_one(self, sender: ComputerName, to: ComputerName) -> None:
        """Make one way between two computers whole; what was kept arrives now."""
        way = self.way(sender, to)
        way.is_cut = False
        kept, way.kept = way.kept, []
        for message in kept:
            self._fly(sender, to, message, self.now)

    def run(self, for_s: float) -> None:
        """Let time pass."""
        end = self.now + seconds(for_s)
        while True:
            running = [process for process in self.processes if process.is_running]
            due = min(process.machine.wake_at() for process in running)
            if self._flights:
                due = min(due, self._flights[0].at)
            if due > end:
                break
            self.now = max(self.now, due)
            while self._flights and self._flights[0].at <= self.now:
                flight = heapq.heappop(self._flights)
                self._arrive(flight)
            for process in running:
                if process.machine.wake_at() <= self.now:
                    self._take(process, process.machine.pass_time(self.now))
                    assert process.machine.wake_at() > self.now
        self.now = end

    def note(self, told: Told, process: Process | None = None) -> None:
        """Let the local backend of a device report."""
        process = process or self.base
        assert isinstance(process.machine, DeviceLink)
        process.machine.note(told, self.now)

    def tell(self, process: Process, command: NodeCommand | LinkCommand) -> None:
        """Let the core of a process command."""
        self._take(process, process.machine.tell(command, self.now))

    def order(self, node: PartName = DRIVE, process: Process | None = None) -> int:
        """Let the supervisor command a node; return the number of the request."""
        request = next(self._requests)
        self.tell(process or self.supervisor, AskTransition(request, node, Transition.CONFIGURE))
        return request

    def engage(self, process: Process, *stops: str) -> None:
        """Let exactly these stops be engaged on a computer."""
        engaged = tuple(PeerStop(StopId(stop), "ada", "test", self.now) for stop in stops)
        self.tell(process, TellStops(engaged))

    def hand(self, process: Process, sender: ComputerName, message: Message) -> None:
        """Let a message arrive out of nowhere."""
        self._take(process, process.machine.hear(sender, message, self.now))

    def _take(self, process: Process, outputs: LinkOutputs) -> None:
        process.inputs += [(self.now, given) for given in outputs.inputs]
        for to, message in outputs.sendings:
            self.sent.append((self.now, to, message))
            way = self.way(process.name, to)
            if way.loses_beats and isinstance(message, Beat):
                continue
            if process.is_hidden:
                continue
            if not way.is_cut:
                extra = 0 if isinstance(message, Beat) else way.order_delay
                arrives = self.now + way.delay + extra
                self._fly(process.name, to, message, arrives)
                if way.doubles:
                    self._fly(process.name, to, message, arrives + seconds(0.05))
            elif way.keeps:
                way.kept.append(message)

    def _fly(self, sender: ComputerName, to: ComputerName, message: Message, at: Instant) -> None:
        heapq.heappush(self._flights, _Flight(at, next(self._ids), sender, to, message))

    def _arrive(self, flight: _Flight) -> None:
        for process in self.processes:
            if process.is_running and process.name == flight.to:
                outputs = process.machine.hear(flight.sender, flight.message, self.now)
                self._take(process, outputs)

    def orders_sent(self) -> list[NodeOrder]:
        """Return all commands that were sent over the link."""
        return [message for _, _, message in self.sent if isinstance(message, NodeOrder)]
