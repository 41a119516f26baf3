"""A simulated network between computers: what is sent arrives late, twice, out of order or never.

Deterministic: the same seed, and the same calls at the same times, lead to the same arrivals.
"""

import heapq
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

from domain.arrays import np
from domain.computers import ComputerName
from domain.timebase import Duration, Instant, seconds

RETRANSMISSION: Duration = seconds(0.2)
"""After which the loss of a message is noticed that is sent again: what TCP waits at the least."""

_MOST_RETRANSMISSIONS = 6

MessageT = TypeVar("MessageT")


@dataclass(frozen=True, slots=True)
class Wire:
    """How one direction between two computers is; without arguments, perfect."""

    delay: Duration = 0
    jitter: Duration = 0
    """Up to which each message is delayed further; messages that may be lost overtake each
    other by it, the others keep their order."""
    loss: float = 0.0
    """Share from 0 to 1. What must not be lost is sent again, and all behind it waits for it."""
    duplication: float = 0.0
    """Share that arrives twice."""
    duplicate_delay: Duration = 0
    """Up to which the second copy comes after the first; also after later messages."""
    is_cut: bool = False
    keeps: bool = False
    """Whether what must not be lost and is sent during a cut arrives after it. Otherwise it is
    lost, as if the connection had been given up."""


PERFECT = Wire()

Direction = tuple[ComputerName, ComputerName]
"""From which computer to which."""


class Arrival(NamedTuple, Generic[MessageT]):
    """A message that has arrived."""

    at: Instant
    sender: ComputerName
    to: ComputerName
    message: MessageT
    may_be_lost: bool


class SimulatedNetwork(Generic[MessageT]):
    """Wires between any number of computers; each direction has faults of its own.

    `now` must never decrease from call to call. What is due at the same time arrives in the order
    in which it was sent.
    """

    def __init__(self, seed: int) -> None:
        """Begin with perfect wires.

        Args:
            seed: Of all chance; not negative.
        """
        self._random = np.random.Generator(np.random.PCG64(seed))
        self._wires: dict[Direction, Wire] = {}
        self._under_way: list[tuple[Instant, int, Arrival[MessageT]]] = []
        self._sent = 0
        self._kept: dict[Direction, list[MessageT]] = {}
        self._last_arrival: dict[Direction, Instant] = {}
        """Of what must not be lost: none is overtaken."""

    # --- what is done to it ----------------------------------------------------------------------

    def set_wire(self, now: Instant, sender: ComputerName, to: ComputerName, wire: Wire) -> None:
        """Change one direction; what is under way arrives as was decided when it was sent."""
        self._wires[sender, to] = wire
        if not wire.is_cut:
            for message in self._kept.pop((sender, to), ()):
                self.send(now, sender, to, message, may_be_lost=False)

    def forget(self, computer: ComputerName) -> None:
        """Lose all that is under way from or to a computer, as when its process is killed."""
        self._under_way = [
            due for due in self._under_way if computer not in (due[2].sender, due[2].to)
        ]
        heapq.heapify(self._under_way)
        for kept in (self._kept, self._last_arrival):
            for direction in [direction for direction in kept if computer in direction]:
                del kept[direction]

    def send(
        self,
        now: Instant,
        sender: ComputerName,
        to: ComputerName,
        message: MessageT,
        *,
        may_be_lost: bool,
    ) -> None:
        """Send a message; whether and when it arrives is decided here."""
        wire = self._wires.get((sender, to), PERFECT)
        if wire.is_cut:
            if wire.keeps and not may_be_lost:
                self._kept.setdefault((sender, to), []).append(message)
            return
        at = now + wire.delay + self._up_to(wire.jitter)
        if may_be_lost:
            if self._happens(wire.loss):
                return
        else:
            at += self._retransmissions(wire)
            at = max(at, self._last_arrival.get((sender, to), at))
            self._last_arrival[sender, to] = at
        self._put(Arrival(at, sender, to, message, may_be_lost))
        if self._happens(wire.duplication):
            again = at + self._up_to(wire.duplicate_delay)
            self._put(Arrival(again, sender, to, message, may_be_lost))

    # --- what it does ----------------------------------------------------------------------------

    def wake_at(self) -> Instant | None:
        """Return when the next message arrives; None: nothing is under way."""
        return self._under_way[0][0] if self._under_way else None

    def empty_at(self) -> Instant | None:
        """Return when all has arrived that is under way now; None: nothing is."""
        return max((at for at, _, _ in self._under_way), default=None)

    def arrivals(self, now: Instant) -> list[Arrival[MessageT]]:
        """Return what arrives up to `now`, in its order; it is under way no more."""
        arrived = []
        while self._under_way and self._under_way[0][0] <= now:
            arrived.append(heapq.heappop(self._under_way)[2])
        return arrived

    # --- chance ----------------------------------------------------------------------------------

    def _put(self, arrival: Arrival[MessageT]) -> None:
        self._sent += 1
        heapq.heappush(self._under_way, (arrival.at, self._sent, arrival))

    def _happens(self, share: float) -> bool:
        """Draw only where something may happen: a perfect wire costs nothing."""
        return share > 0.0 and self._random.random() < share

    def _up_to(self, longest: Duration) -> Duration:
        return int(self._random.random() * longest) if longest else 0

    def _retransmissions(self, wire: Wire) -> Duration:
        """Return the time until a message is through; each loss doubles the wait, as in TCP."""
        waited, wait = 0, RETRANSMISSION
        for _ in range(_MOST_RETRANSMISSIONS):
            if not self._happens(wire.loss):
                break
            waited, wait = waited + wait, 2 * wait
        return waited
