"""Emergency stops over the link: those of this computer, and those of another one."""

from collections import deque
from collections.abc import Iterable, Sequence, Set
from typing import NamedTuple

from domain.computers import Incarnation, PeerStop, StopId
from domain.link.messages import EngagedStop
from domain.timebase import Instant

MAX_STOPS = 64
"""Stops of one process that are told and taken in at most; the robot is stopped by one."""
_MAX_PROCESSES = 8
"""Processes of one name whose stops are known at most, beside the one that is dealt with."""


class OwnStops:
    """The stops that are engaged on this computer, as every other one is told."""

    def __init__(self) -> None:
        """Begin without a stop."""
        self.version = 0
        """Rises with each change."""
        self._stops: tuple[PeerStop, ...] = ()
        self._released: set[StopId] = set()
        """Those whose release the core was told; it has not said yet that they are."""

    def set(self, stops: Iterable[PeerStop]) -> bool:
        """Set all stops; return whether that is a change."""
        kept = tuple(stops)[:MAX_STOPS]
        if kept == self._stops:
            return False
        self._stops = kept
        self._released &= {stop.id for stop in kept}
        self.version += 1
        return True

    def told(self, now: Instant) -> tuple[EngagedStop, ...]:
        """Return them as they are told to others now."""
        return _told(self._stops, now)

    def take_release(self, asked: Iterable[StopId]) -> tuple[StopId, ...]:
        """Return those of the stops that somebody releases now, for the first time."""
        own = {stop.id for stop in self._stops} - self._released
        taken = tuple(dict.fromkeys(stop for stop in asked if stop in own))
        self._released.update(taken)
        return taken


class _StopsOf:
    """What one process says of its stops."""

    def __init__(self) -> None:
        self.heard_at: Instant = 0
        self.version = -1
        self.is_certain = False
        """Whether it was dealt with, or known to live, when it said so."""
        self.stops: dict[StopId, PeerStop] = {}
        self.had: dict[StopId, None] = {}
        """All that it said it has, the latest at the end; it may have ended some since."""

    def note(self, said: Iterable[EngagedStop]) -> None:
        """Note which stops it has, or had."""
        for stop in said:
            self.had[stop.id] = self.had.pop(stop.id, None)
        while len(self.had) > MAX_STOPS:
            del self.had[next(iter(self.had))]


class StopsNews(NamedTuple):
    """What is new about the stops of another computer; see `PeerStops`."""

    stops: tuple[PeerStop, ...]
    ended: tuple[StopId, ...] | None
    is_dealt_with: bool


class HeardStops:
    """The stops that are engaged on another computer, by the process that says so.

    Anybody who answers by its name can engage one. A stop ends when its own process no longer has
    it, or the one that is dealt with no longer has what a store brought back to it. A stop of any
    other process that is no longer heard is ended by a person who names it: it may live, and only
    be cut off.
    """

    def __init__(self) -> None:
        """Begin without a stop, and without a word of the computer."""
        self._by: dict[Incarnation, _StopsOf] = {}
        self._ended = deque[StopId](maxlen=MAX_STOPS)
        """Stops of processes that were replaced: they may arrive late."""
        self._told = (frozenset[StopId](), False, False)

    @property
    def ids(self) -> frozenset[StopId]:
        """Return the ids of all of them."""
        return frozenset(stop for of in self._by.values() for stop in of.stops)

    def version_of(self, process: Incarnation | None) -> int:
        """Return the last version of a process that was taken in; 0: none."""
        known = self._by.get(process) if process is not None else None
        return max(known.version, 0) if known is not None else 0

    def ids_of(self, process: Incarnation) -> frozenset[StopId]:
        """Return the ids of the stops of one process."""
        return frozenset(self._by[process].stops) if process in self._by else frozenset()

    def take(
        self,
        process: Incarnation,
        version: int,
        stops: Sequence[EngagedStop],
        now: Instant,
        *,
        lives: bool,
        is_dealt_with: bool,
    ) -> None:
        """Take in what a process says: all its stops.

        Args:
            process: Who says so.
            version: Of what it says; an older one is no news.
            stops: Its stops, with their ages.
            now: The current time.
            lives: Whether it is known to have said so just now, so that no stop is an old one.
            is_dealt_with: Whether it is the one that answers for its computer.
        """
        known = self._by.get(process) or _StopsOf()
        known.heard_at = now
        known.is_certain |= lives or is_dealt_with
        said = stops[:MAX_STOPS]
        known.note(said)
        if is_dealt_with and len(self._by) > 1:
            self._take_over(process, known.had.keys())
        if version <= known.version:
            return
        old = () if lives or is_dealt_with else self._ended
        taken = tuple(stop for stop in said if stop.id not in old)
        if not is_dealt_with and process not in self._by and not self._has_room_for(taken):
            return
        self._by[process] = known
        self._drop_oldest(besides=process)
        if len(taken) == len(said):
            known.version = version
        known.stops = {
            stop.id: known.stops.get(stop.id)
            or PeerStop(stop.id, stop.by, stop.reason, now - max(stop.age, 0))
            for stop in taken
        }

    def is_certain(self, process: Incarnation) -> bool:
        """Tell whether a process has a stop, and was dealt with, or lived, when it said so."""
        known = self._by.get(process)
        return known is not None and known.is_certain and bool(known.stops)

    def replace(self, process: Incarnation) -> None:
        """End all stops of a process that was replaced."""
        replaced = self._by.pop(process, None)
        if replaced is not None:
            self._ended.extend(replaced.stops)

    def heard_at(self, process: Incarnation) -> Instant:
        """Return when a process was heard last that said something."""
        return self._by[process].heard_at

    def end(self, process: Incarnation, stops: Iterable[StopId]) -> None:
        """End stops of a process that nobody can ask, and that a person names."""
        known = self._by.get(process)
        if known is not None:
            for stop in stops:
                known.stops.pop(stop, None)
            if not known.stops:
                del self._by[process]

    def told(self, now: Instant) -> dict[Incarnation, tuple[int, tuple[EngagedStop, ...]]]:
        """Return by process what it said last: the version, and the stops as they are told now."""
        return {
            process: (max(known.version, 0), _told(known.stops.values(), now))
            for process, known in self._by.items()
        }

    def processes(self) -> tuple[Incarnation, ...]:
        """Return all processes that said something."""
        return tuple(self._by)

    def news(self, *, is_dealt_with: bool, is_all: bool) -> StopsNews | None:
        """Return all stops, and which ended, if that is news; None: it is not.

        Args:
            is_dealt_with: Whether the computer itself told its stops.
            is_all: Whether all who live told theirs: what an earlier run of this computer knew,
                and nobody says, has ended.
        """
        ids = self.ids
        known, *_ = before = self._told
        self._told = (ids, is_dealt_with, is_all)
        if self._told == before:
            return None
        stops = tuple(stop for of in self._by.values() for stop in of.stops.values())
        ended = None if is_all else tuple(sorted(known - ids))
        return StopsNews(stops[:MAX_STOPS], ended, is_dealt_with)

    def _take_over(self, process: Incarnation, ids: Set[StopId]) -> None:
        """Let stops be those of the process that is dealt with, which its store brought back."""
        for other in [each for each in self._by if each != process]:
            known = self._by[other]
            brought_back = known.stops.keys() & ids
            for stop in brought_back:
                del known.stops[stop]
            self._ended.extend(brought_back)
            if brought_back and not known.stops:
                del self._by[other]

    def _drop_oldest(self, besides: Incarnation) -> None:
        """Forget who was heard longest ago of too many; the others stop the robot as well."""
        if len(self._by) > _MAX_PROCESSES + 1:
            others = [process for process in self._by if process != besides]
            self.replace(min(others, key=self.heard_at))

    def _has_room_for(self, stops: Sequence[EngagedStop]) -> bool:
        """Tell whether one more process can be remembered; without a stop there is no need to."""
        return bool(stops) and len(self._by) < _MAX_PROCESSES


def _told(stops: Iterable[PeerStop], now: Instant) -> tuple[EngagedStop, ...]:
    return tuple(
        EngagedStop(stop.id, stop.by, stop.reason, max(now - stop.since, 0)) for stop in stops
    )
