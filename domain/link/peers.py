"""All other computers of the robot: beats to them, beats of them, and emergency stops."""

from collections.abc import Callable, Iterable, Iterator

from domain.commands import AskRelease, TellStops
from domain.computers import ComputerName
from domain.inputs import PeerStops, StopsReleased
from domain.link.gathering import Gathering
from domain.link.messages import Beat
from domain.link.peer import Heard, Own, Peer, Said
from domain.link.settings import LinkSettings
from domain.link.stops import OwnStops
from domain.timebase import Instant

_MAX_STRANGERS = 8
"""Computers that the robot file does not have, of which stops are taken, at most."""


class Peers:
    """What this computer knows of each other one, and says to it."""

    def __init__(
        self,
        own: Own,
        settings: LinkSettings,
        close: Iterable[ComputerName],
        distant: Iterable[ComputerName],
        says: Callable[[Peer, Instant], Said],
        start: Instant,
    ) -> None:
        """Begin without having heard of anybody.

        Args:
            own: What this computer says of itself.
            settings: Times of the link.
            close: Computers that command this one, or are commanded by it.
            distant: The others, which are told of stops only.
            says: Returns what else a beat says.
            start: The current time.
        """
        self.own = own
        self.stops = OwnStops()
        self.stops_changes = 0
        """How often the stops of another computer changed."""
        self._settings = settings
        self._says = says
        self._peers = {
            name: Peer(name, own, self.stops, each, start)
            for names, each in ((close, settings), (distant, settings.slowly))
            for name in names
        }
        self._wakes = {name: peer.wake_at() for name, peer in self._peers.items()}

    def __getitem__(self, name: ComputerName) -> Peer:
        """Return what is known of a computer."""
        return self._peers[name]

    def __iter__(self) -> Iterator[Peer]:
        """Iterate over all computers that are known, or were heard."""
        return iter(self._peers.values())

    def wake_at(self) -> Instant:
        """Return when the next beat, or the end of a lease, is due."""
        return min(self._wakes.values())

    def pass_time(self, now: Instant) -> list[Peer]:
        """Judge what was heard by the time since; return those to whom the connection is lost."""
        lost: list[Peer] = []
        for peer in [peer for peer in self if self._wakes[peer.name] <= now]:
            if peer.pass_time(now):
                lost.append(peer)
            self._wakes[peer.name] = peer.wake_at()
            if peer.is_forgotten:
                del self._peers[peer.name], self._wakes[peer.name]
        return lost

    def hear(self, beat: Beat, now: Instant, gathering: Gathering) -> tuple[Peer, Heard] | None:
        """Take a beat; what it says of stops is given to the core.

        Returns:
            Who sent it, and what it was; None: whom we do not know, and cannot remember.
        """
        peer = self._peers.get(beat.sender)
        if peer is None:
            peer = self._meet(beat.sender, now)
            if peer is None:
                return None
        heard = peer.hear(beat, now)
        self._wakes[peer.name] = peer.wake_at()
        self._tell_stops(peer, now, gathering)
        if heard is not Heard.NOTHING and beat.releases and peer.is_renewed_by(beat, now):
            released = self.stops.take_release(beat.releases)
            if released:
                gathering.give(StopsReleased(released, peer.name))
        return peer, heard

    def take_passed_on(self, beat: Beat, now: Instant, gathering: Gathering) -> None:
        """Take what a beat of the supervisor passes on, if it was sent just now."""
        if not beat.passed_on or not self._peers[beat.sender].is_renewed_by(beat, now):
            return
        for peer in self:
            said = [each for each in beat.passed_on if each.computer == peer.name]
            if said and peer.name != beat.sender:
                peer.take_passed_on(said, now)
                self._tell_stops(peer, now, gathering)

    def tell(self, command: TellStops | AskRelease, now: Instant, gathering: Gathering) -> None:
        """Take a command of the core that concerns stops; what follows is said at once."""
        if isinstance(command, TellStops):
            if self.stops.set(command.stops):
                self.beat(self, now, gathering)
        elif (peer := self._peers.get(command.computer)) is not None:
            peer.ask_release(command.stops)
            self._tell_stops(peer, now, gathering)
            if peer.releases:
                self.beat((peer,), now, gathering)

    def beat_if_due(self, now: Instant, gathering: Gathering) -> None:
        """Send all beats that are due."""
        self.beat((peer for peer in self if peer.next_beat_at <= now), now, gathering)

    def beat(self, peers: Iterable[Peer], now: Instant, gathering: Gathering) -> None:
        """Send a beat now."""
        for peer in peers:
            gathering.send(peer.name, peer.beat(self._says(peer, now), now))
            self._wakes[peer.name] = peer.wake_at()

    def _tell_stops(self, peer: Peer, now: Instant, gathering: Gathering) -> None:
        news = peer.stops_news(now)
        if news is not None:
            self.stops_changes += 1
            gathering.give(PeerStops(peer.name, *news))

    def _meet(self, name: ComputerName, now: Instant) -> Peer | None:
        if sum(not peer.is_known for peer in self) == _MAX_STRANGERS:
            return None
        settings = self._settings.slowly
        stranger = Peer(name, self.own, self.stops, settings, now, is_known=False)
        self._peers[name], self._wakes[name] = stranger, now
        return stranger
