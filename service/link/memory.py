"""A network in memory: links between computers in one process, with the faults of a real network.

On the clock that it is given, so that hours of cuts and losses take a moment, and run the same each
time.
"""

from collections.abc import Iterable, Sequence
from itertools import chain

from domain.computers import ComputerName
from domain.simulation.network import SimulatedNetwork, Wire
from domain.timebase import Instant, to_seconds
from service.clock import Clock
from service.link.intake import Intake
from service.link.port import MAX_MESSAGE_BYTES, DeliverMessage, LinkCounts
from service.pacing import Pacer


class MemoryNetwork:
    """Computers of one robot and the wires between them.

    Args:
        names: All computers.
        clock: Says when a message arrives.
        seed: Of all chance.
    """

    def __init__(self, names: Iterable[ComputerName], clock: Clock, seed: int = 0) -> None:
        self.names = tuple(names)
        self._clock = clock
        self._network = SimulatedNetwork[bytes](seed)
        self._running: dict[ComputerName, list[MemoryLink]] = {name: [] for name in self.names}

    def link(self, name: ComputerName) -> "MemoryLink":
        """Return the link of a computer; if several of one name run, each gets what is for it."""
        return MemoryLink(self, name, self._clock)

    def set_wire(self, sender: ComputerName, to: ComputerName, wire: Wire) -> None:
        """Change one direction between two computers."""
        self._network.set_wire(self._clock.now(), sender, to, wire)
        self._touch()

    def set_cut(self, one: ComputerName, other: ComputerName, *, is_cut: bool) -> None:
        """Cut both directions between two computers, or make them perfect."""
        for sender, to in ((one, other), (other, one)):
            self.set_wire(sender, to, Wire(is_cut=is_cut))

    # --- for the links ---------------------------------------------------------------------------

    def attach(self, link: "MemoryLink") -> None:
        """Let a link receive what is for its computer."""
        self._running[link.name].append(link)

    def detach(self, link: "MemoryLink") -> None:
        """Hand nothing to a link any more; with the last of its name goes what is under way."""
        self._running[link.name].remove(link)
        if not self._running[link.name]:
            self._network.forget(link.name)

    def send(
        self, sender: ComputerName, to: ComputerName, message: bytes, *, may_be_lost: bool
    ) -> None:
        """Put a message on the wire."""
        self._network.send(self._clock.now(), sender, to, message, may_be_lost=may_be_lost)
        self._touch()

    def wake_at(self) -> Instant | None:
        """Return when a message arrives next."""
        return self._network.wake_at()

    def advance(self, now: Instant) -> Sequence[object]:
        """Hand every message that has arrived to the link that it is for; return nothing."""
        for arrival in self._network.arrivals(now):
            for link in self._running[arrival.to]:
                link.intake.take_in(
                    arrival.sender, arrival.message, may_be_lost=arrival.may_be_lost
                )
        return ()

    def _touch(self) -> None:
        for link in chain.from_iterable(self._running.values()):
            link.pacer.touch()


class MemoryLink:
    """A `Link` of one computer to a `MemoryNetwork`."""

    def __init__(self, network: MemoryNetwork, name: ComputerName, clock: Clock) -> None:
        self.name = name
        self.pacer = Pacer[object](network, clock)
        """Wakes when anything arrives anywhere: whichever link wakes first hands all out."""
        others = [other for other in network.names if other != name]
        self.intake = Intake(others, lambda: to_seconds(clock.now()))
        self._network = network
        self._others = frozenset(others)
        self._is_running = False
        self._unsent = 0

    async def run(self, deliver: DeliverMessage) -> None:
        """Deliver messages until cancelled."""
        self.intake.open(deliver)
        self._network.attach(self)
        self._is_running = True
        try:
            await self.pacer.run(lambda _: None)
        finally:
            self._is_running = False
            self._network.detach(self)
            self.intake.close()

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool) -> None:
        """Send a message."""
        if to not in self._others or len(message) > MAX_MESSAGE_BYTES:
            self._unsent += 1
        elif self._is_running:
            self._network.send(self.name, to, message, may_be_lost=may_be_lost)

    def counts(self) -> LinkCounts:
        """Return what was dropped since the link was made."""
        counts = self.intake.counts()
        return LinkCounts(counts.received, counts.unknown, self._unsent)
