"""The emergency stops of all computers of a robot, as far as they are known on this one."""

from collections.abc import Collection, Iterable, Mapping

from domain.computers import ComputerName, PeerStop, StopId, StopView, computer_words
from domain.health.signal_monitor import StopCause


class EngagedStops:
    """The stop of this computer, those of its peers, and which of the peers can be heard.

    What a peer said last holds until it says something else: one that cannot be heard may still
    have its stops engaged.
    """

    def __init__(self, peers: Iterable[ComputerName]) -> None:
        """Begin without a stop; no peer was heard yet.

        Args:
            peers: The other computers of the robot.
        """
        self.peers = tuple(peers)
        self.own: PeerStop | None = None
        self._of_peers: dict[ComputerName, dict[StopId, PeerStop]] = {}
        self._told = set[ComputerName]()
        """Peers that told which stops they have."""
        self._heard: dict[ComputerName, bool] = {}
        """Whether a peer can be heard, where the link says so."""
        self._asked: dict[ComputerName, set[StopId]] = {}
        """Stops that their computers were asked to release."""

    # --- what happens ----------------------------------------------------------------------------

    def add(self, computer: ComputerName, stop: PeerStop) -> None:
        """Note a stop of a peer."""
        self._of_peers.setdefault(computer, {})[stop.id] = stop

    def remove(self, computer: ComputerName, stop: StopId) -> None:
        """Note that a stop of a peer is released."""
        self._of_peers[computer].pop(stop)
        self._asked.get(computer, set()).discard(stop)
        if not self._of_peers[computer]:
            del self._of_peers[computer]

    def note_told(self, computer: ComputerName) -> None:
        """Note that a peer told which stops it has."""
        self._told.add(computer)

    def note_connection(self, computer: ComputerName, *, is_heard: bool) -> None:
        """Note whether a peer can be heard; if not, what it was asked to release is void.

        A release that arrived with the first words after a cut would set the robot in motion, and
        nobody would look at it by then.
        """
        self._heard[computer] = is_heard
        if not is_heard:
            self._asked.pop(computer, None)

    def note_asked(self, computer: ComputerName, stops: Iterable[StopId]) -> None:
        """Note that a peer was asked to release stops."""
        self._asked.setdefault(computer, set()).update(stops)

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def is_any(self) -> bool:
        """Tell whether a stop is engaged on any computer."""
        return self.own is not None or bool(self._of_peers)

    def of(self, computer: ComputerName) -> Mapping[StopId, PeerStop]:
        """Return the stops of a peer by their ids."""
        return self._of_peers.get(computer, {})

    def is_heard(self, computer: ComputerName) -> bool:
        """Tell whether a peer can be heard."""
        return self._heard.get(computer, computer in self._told)

    def to_ask(self, named: Collection[StopId] | None) -> Mapping[ComputerName, tuple[StopId, ...]]:
        """Return what peers that can be heard have to release.

        Args:
            named: The stops that somebody releases; None: all.
        """
        found = {
            computer: tuple(stop for stop in stops if named is None or stop in named)
            for computer, stops in self._of_peers.items()
            if self.is_heard(computer)
        }
        return {computer: stops for computer, stops in found.items() if stops}

    @property
    def stopping_peers(self) -> tuple[ComputerName, ...]:
        """Return the peers on which a stop is engaged."""
        return tuple(self._of_peers)

    @property
    def waited_for(self) -> tuple[ComputerName, ...]:
        """Return the peers that were asked to release a stop, and did not do so yet."""
        return tuple(computer for computer, stops in self._asked.items() if stops)

    @property
    def not_heard(self) -> tuple[ComputerName, ...]:
        """Return the peers that cannot be heard."""
        return tuple(computer for computer in self.peers if not self.is_heard(computer))

    def views(self) -> tuple[StopView, ...]:
        """Return all stops, the oldest first."""
        own = () if self.own is None else (_view(None, self.own),)
        others = (
            _view(computer, stop)
            for computer, stops in self._of_peers.items()
            for stop in stops.values()
        )
        return tuple(sorted((*own, *others), key=lambda view: (view.since, view.computer or "")))

    def causes(self) -> tuple[StopCause, ...]:
        """Return why the robot is stopped: one cause for each computer, this one first."""
        own = () if self.own is None else (StopCause(_ENGAGED, self.own.since),)
        return (*own, *(self._cause(computer) for computer in self._of_peers))

    def _cause(self, computer: ComputerName) -> StopCause:
        since = min(stop.since for stop in self._of_peers[computer].values())
        silent = "" if self.is_heard(computer) else ", which has not been heard"
        return StopCause(f"{_ENGAGED} at {computer_words(computer)}{silent}", since)


_ENGAGED = "emergency stop is engaged"


def _view(computer: ComputerName | None, stop: PeerStop) -> StopView:
    return StopView(stop.id, computer, stop.by, stop.reason, stop.since)
