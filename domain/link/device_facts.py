"""What a device says of its nodes and signals, and what of it the core was given."""

from collections.abc import Iterable, Iterator

from domain.inputs import NodeReport, Readings
from domain.link.facts import Facts, difference
from domain.link.messages import Told
from domain.state_and_mode import PartName
from domain.timebase import Duration, Instant


class DeviceFacts:
    """Gives the core what is new to it.

    What the device tells at once is given as it was told. A complete report repeats what is known:
    only what differs is given, and readings only if one may have been missed, since a reading is as
    old for the core as its arrival.
    """

    def __init__(self, tolerance: Duration) -> None:
        """Begin without a fact.

        Args:
            tolerance: How long one and the same reading may be on its way, more or less.
        """
        self._tolerance = tolerance
        self._said = Facts()
        self._given = Facts()
        self.is_complete = False
        """Whether the device said everything, since it was asked to begin anew."""
        self._is_behind = True

    def begin_anew(self) -> None:
        """Wait for everything to be said again; what the core was given stays known to it."""
        self._said = Facts()
        self.is_complete = False
        self._is_behind = True

    def note_gap(self) -> None:
        """Note that something may have been missed."""
        self._is_behind = True

    def note(self, items: Iterable[Told], now: Instant, *, is_complete: bool) -> None:
        """Note what a device says that is not connected yet: nothing is given."""
        if is_complete:
            self._said = Facts()
        for told in items:
            self._said.note(told, now)
        self.is_complete |= is_complete

    def take(self, items: Iterable[Told], now: Instant, *, is_complete: bool) -> Iterator[Told]:
        """Yield what of the words of a connected device is to be given to the core."""
        if not is_complete:
            for told in items:
                yield self._given_now(told, now)
            return
        self.note(items, now, is_complete=True)
        for node, facts in self._said.nodes.items():
            changed = difference(self._given.nodes.get(node), facts)
            if changed is not None:
                yield self._given_now(changed, now)
        yield from self._missed(now)

    def give_all(self, now: Instant) -> Iterator[Told]:
        """Yield everything that the device said, for the core to begin with."""
        for facts in self._said.nodes.values():
            yield self._given_now(facts, now)
        yield from self._missed(now)

    def give_unreachable(self, nodes: Iterable[PartName], now: Instant) -> Iterator[Told]:
        """Yield that nodes are unreachable."""
        for node in nodes:
            yield self._given_now(NodeReport(node, reachable=False), now)

    def _given_now(self, told: Told, now: Instant) -> Told:
        self._given.note(told, now)
        return told

    def _missed(self, now: Instant) -> Iterator[Told]:
        """Yield readings, faults of sources and errors that the core was not given."""
        if not self._is_behind:
            return
        self._is_behind = False
        for told in self._said.others():
            is_known = self._knows(told) if isinstance(told, Readings) else told in self._given
            if not is_known:
                yield self._given_now(told, now)

    def _knows(self, told: Readings) -> bool:
        """Tell whether the core was given a reading: the same value, at about the same time."""
        (reading,) = told.items
        known = self._given.reading(told.source, reading.signal)
        if known is None or known[0].value != reading.value or reading.stamp is None:
            return False
        return reading.stamp <= known[1] + self._tolerance
