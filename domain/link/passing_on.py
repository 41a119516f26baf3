"""How the supervisor passes on to each device what the others say of their stops."""

from itertools import chain

from domain.computers import ComputerName
from domain.link.messages import StopsPassedOn
from domain.link.peer import Peer
from domain.link.peers import Peers
from domain.timebase import Duration, Instant, seconds

EVERY: Duration = seconds(1)
"""How often a device is told what it was told before: a beat may be lost."""


class PassingOn:
    """Notes what each device was told of the others, and when."""

    def __init__(self, peers: Peers) -> None:
        """Begin with nothing to pass on.

        Args:
            peers: All other computers of the robot.
        """
        self._peers = peers
        self._stopped: set[ComputerName] = set()
        """Computers on which a stop was engaged."""
        self._told: dict[ComputerName, tuple[Instant, int]] = {}
        """By device, when it was told, and after how many changes."""

    def beat_says(self, to: Peer, now: Instant) -> tuple[StopsPassedOn, ...]:
        """Return what a beat to a device passes on; most have nothing to."""
        self._stopped |= {peer.name for peer in self._peers if peer.stops.ids}
        others = [peer for peer in self._peers if peer.name in self._stopped and peer is not to]
        if not others:
            return ()
        changes = self._peers.stops_changes
        at, told = self._told.get(to.name, (now - EVERY, -1))
        if told == changes and now - at < EVERY:
            return ()
        self._told[to.name] = now, changes
        return tuple(chain.from_iterable(peer.pass_on(now) for peer in others))
