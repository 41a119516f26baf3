"""What one computer of a robot knows of another, and what it says to it.

The same on both ends. By one name several processes may answer, one after the other or at once; one
of them is dealt with. That one is replaced only after it was silent for `lost`, so that nobody
takes the place of a process that lives.
"""

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from typing import NamedTuple

from domain.computers import (
    SUPERVISOR,
    ComputerName,
    DeviceState,
    Incarnation,
    Session,
    StopId,
)
from domain.link.lease import Lease
from domain.link.messages import Beat, StopsPassedOn, Terms
from domain.link.processes import Other, Others
from domain.link.settings import LinkSettings
from domain.link.stops import MAX_STOPS, HeardStops, OwnStops, StopsNews
from domain.link.terms import (
    DEVICE_CONFLICT,
    SECOND_SUPERVISOR,
    UNKNOWN_DEVICE,
    Refusal,
    find_refusal,
)
from domain.timebase import Instant

_MAX_FORMER = 8
"""Processes that were replaced, and are remembered, at most."""


@dataclass(frozen=True, slots=True)
class Own:
    """What a computer says of itself."""

    name: ComputerName
    incarnation: Incarnation
    terms: Terms


class Said(NamedTuple):
    """What a beat says besides what is the same for both ends; see `Beat`."""

    session: Session | None = None
    renew: Session | None = None
    autonomous: bool = False
    passed_on: tuple[StopsPassedOn, ...] = ()


class Heard(Enum):
    """What a beat was."""

    NOTHING = auto()
    """It is old, or of a process that is not dealt with."""
    NEWS = auto()
    """It is of the process that is dealt with."""
    LEASE = auto()
    """The same, and the lease begins with it."""


class Peer:
    """Another computer of the robot, by its name."""

    def __init__(
        self,
        name: ComputerName,
        own: Own,
        stops: OwnStops,
        settings: LinkSettings,
        start: Instant,
        *,
        is_known: bool = True,
    ) -> None:
        """Begin without having heard of it.

        Args:
            name: Of the other computer.
            own: What this computer says of itself.
            stops: Those that are engaged on this computer.
            settings: Times of this link.
            start: The current time; the first beat is due then.
            is_known: Whether the robot file has it; who is unknown is refused, but can stop.
        """
        self.name = name
        self.is_known = is_known
        self.lease = Lease(settings)
        self.stops = HeardStops()
        self.incarnation: Incarnation | None = None
        """The process that is dealt with; None: none was heard that fits."""
        self.terms: Terms | None = None
        """Of that process."""
        self.was_connected = False
        self.heard_seq = 0
        """Of its newest beat."""
        self.beats_heard = 0
        self.beats_missed = 0
        self.refused_by: Refusal | None = None
        """Why it does not deal with this process, as it says; None: it does not say so."""
        self.releases: dict[StopId, None] = {}
        """Stops of the other that a person released here."""
        self.next_beat_at = start
        self._own = own
        self._own_stops = stops
        self._settings = settings
        self._others = Others(settings.lost)
        self._former = deque[Incarnation](maxlen=_MAX_FORMER)
        self._listens_since = self._began_at = start
        """When the process that is dealt with was heard first."""
        self._acknowledged = 0
        """Version of our stops that it has taken in."""

    # --- what can be seen ------------------------------------------------------------------------

    def state(self) -> DeviceState:
        """Return how the connection is."""
        if self.lease.is_held:
            return DeviceState.LATE if self.lease.is_late else DeviceState.CONNECTED
        if self.refused_by is not None or self._misfit() is not None:
            return DeviceState.CONFLICT
        return DeviceState.LOST if self.was_connected else DeviceState.NEVER_SEEN

    def reason(self, now: Instant) -> str:
        """Return why it is late or not connected, as a sentence about it; empty: neither."""
        if self.lease.is_held:
            return f"{self.words} {self.lease.why_late(now)}" if self.lease.is_late else ""
        if self.refused_by is not None:
            return f"{self.words} refuses this computer: {self.refused_by.message}"
        misfit = self._misfit()
        if misfit is not None:
            return f"{self.words} is not dealt with: {misfit.message}"
        return f"{self.words} {self.lease.why_lost(now)}"

    @property
    def words(self) -> str:
        """Return its name in words."""
        return "the supervisor" if self.name == SUPERVISOR else f"device {self.name}"

    @property
    def refused(self) -> str:
        """Return why another process of its name is refused; empty: there is none."""
        found = next((other.refusal for other in self._others if other.refusal is not None), None)
        return "" if found is None else found.message

    @property
    def has_acknowledged(self) -> bool:
        """Tell whether it has taken in the stops of this computer as they are now."""
        return self._acknowledged == self._own_stops.version

    @property
    def is_forgotten(self) -> bool:
        """Tell whether it is none of the robot, and no longer heard, and has no stop."""
        return not self.is_known and not len(self._others) and not self.stops.ids

    def is_renewed_by(self, beat: Beat, now: Instant) -> bool:
        """Tell whether the lease holds, and a beat was sent just now."""
        return self.lease.is_held and self._lives(beat, now)

    def wake_at(self) -> Instant:
        """Return when something is due next."""
        due = [self.next_beat_at]
        ends = self.lease.wake_at()
        if ends is not None:
            due.append(ends)
        forgets = self._others.wake_at()
        if forgets is not None:
            due.append(forgets)
        if self.refused_by is not None and self.lease.heard_at is not None:
            due.append(self.lease.heard_at + self._settings.lost)
        return min(due)

    # --- what happens ----------------------------------------------------------------------------

    def pass_time(self, now: Instant) -> bool:
        """Judge what was heard by the time since; return whether the connection is lost by that."""
        self._others.forget_silent(now)
        if self.lease.is_silent(now):
            self.refused_by = None
        if not self.lease.judge(now):
            return False
        # A release must not come true long after somebody asked for it.
        self.releases.clear()
        return True

    def hear(self, beat: Beat, now: Instant) -> Heard:
        """Take a beat that came by the name of this computer."""
        refusal = self._find_refusal(beat.terms)
        lives = self._lives(beat, now)
        if beat.incarnation == self.incarnation and refusal is None:
            return self._hear_incumbent(beat, now, lives=lives)
        other = self._others.meet(beat.incarnation, now)
        if beat.seq <= other.seq:
            return Heard.NOTHING
        other.seq, other.heard_at = beat.seq, now
        other.refusal = refusal or other.refusal
        if lives and other.proven_after is None:
            other.proven_after = self.lease.next_seq - 1
        if refusal is None and (self.incarnation is None or self.lease.is_silent(now)):
            self._adopt(other)
            return self._hear_incumbent(beat, now, lives=lives)
        # Whoever it is: a stop is taken.
        stops = beat.stops
        self.stops.take(
            other.incarnation, beat.stops_version, stops, now, lives=lives, is_dealt_with=False
        )
        return Heard.NOTHING

    def ask_release(self, stops: Iterable[StopId]) -> None:
        """Let stops of the other be released that a person saw here.

        Those of a computer that is not connected stay: it must be asked again.
        """
        asked = tuple(stops)
        if not self.lease.is_held and self.is_known:
            return
        for process in self.stops.processes():
            if process != self.incarnation and process not in self._others:
                self.stops.end(process, asked)
        if self.incarnation is not None:
            own = self.stops.ids_of(self.incarnation)
            for stop in asked:
                if stop in own and len(self.releases) < MAX_STOPS:
                    self.releases[stop] = None

    def pass_on(self, now: Instant) -> list[StopsPassedOn]:
        """Return what its processes said last of their stops."""
        return [
            StopsPassedOn(self.name, process, version, stops, process == self.incarnation)
            for process, (version, stops) in self.stops.told(now).items()
        ]

    def take_passed_on(self, all_said: Sequence[StopsPassedOn], now: Instant) -> None:
        """Take what the supervisor heard of its processes; a beat of their own says the same.

        A process that was replaced there, and is silent here, has no stop any more.
        """
        for said in all_said:
            self.stops.take(
                said.incarnation,
                said.version,
                said.stops,
                now,
                lives=True,
                is_dealt_with=said.is_dealt_with,
            )
        if not any(said.is_dealt_with for said in all_said):
            return
        present: set[Incarnation | None] = {said.incarnation for said in all_said}
        if not self.lease.is_silent(now):
            present.add(self.incarnation)
        for process in self.stops.processes():
            if process not in present and process not in self._others:
                self.stops.replace(process)

    def stops_news(self, now: Instant) -> StopsNews | None:
        """Return its stops, if they are news; None: they are not.

        Another process of its name, which has a stop and is not dealt with, may be heard later than
        the one that is.
        """
        is_all = self.was_connected and now >= self._listens_since + self._settings.lost
        return self.stops.news(is_dealt_with=self.was_connected, is_all=is_all)

    def beat(self, said: Said, now: Instant) -> Beat:
        """Return a beat for it; the next is due a period later."""
        is_told = self.has_acknowledged or not self.lease.is_held
        period = self._settings.beat if is_told else self._settings.urgent
        self.next_beat_at = now + period
        return Beat(
            self._own.name,
            self._own.incarnation,
            self.lease.note_sent(now),
            self._own.terms,
            heard=self.incarnation,
            heard_seq=self.heard_seq,
            session=said.session,
            renew=said.renew,
            autonomous=said.autonomous,
            stops=self._own_stops.told(now),
            stops_version=self._own_stops.version,
            heard_stops=self.stops.version_of(self.incarnation),
            releases=tuple(self.releases),
            refused=self._others.refused(),
            passed_on=said.passed_on,
        )

    # --- who answers -----------------------------------------------------------------------------

    def _lives(self, beat: Beat, now: Instant) -> bool:
        """Tell whether a beat was sent just now: it echoes one of ours that was."""
        is_echo = beat.heard == self._own.incarnation
        return is_echo and self.lease.was_sent_lately(beat.heard_seq, now)

    def _find_refusal(self, terms: Terms) -> Refusal | None:
        if not self.is_known:
            return Refusal(UNKNOWN_DEVICE, "the robot file has no such device")
        return find_refusal(self._own.terms, terms)

    def _misfit(self) -> Refusal | None:
        """Return why somebody who answers by this name does not fit; None: nobody does so."""
        for other in self._others:
            if other.refusal is not None and other.refusal.code != self._conflict.code:
                return other.refusal
        return None

    @property
    def _conflict(self) -> Refusal:
        if self.name == SUPERVISOR:
            return Refusal(SECOND_SUPERVISOR, "another supervisor is followed")
        return Refusal(DEVICE_CONFLICT, f"another process is device {self.name}")

    def _adopt(self, other: Other) -> None:
        """Deal with another process from now on."""
        if self.incarnation is not None:
            self._former.append(self.incarnation)
        self.incarnation, self._began_at = other.incarnation, other.first_heard_at
        self.heard_seq = self._acknowledged = 0
        self.refused_by = None
        self.releases.clear()
        self.lease.forget()
        self._others.forget(other.incarnation)

    def _hear_incumbent(self, beat: Beat, now: Instant, *, lives: bool) -> Heard:
        if beat.seq <= self.heard_seq:
            return Heard.NOTHING
        self.beats_heard += 1
        self.beats_missed += beat.seq - self.heard_seq - 1 if self.heard_seq else 0
        self.heard_seq, self.terms = beat.seq, beat.terms
        self.lease.note_heard(now)
        begins = False
        if beat.heard == self._own.incarnation:
            begins = self.lease.take_echo(beat.heard_seq, now)
            self._acknowledged = beat.heard_stops
        self.refused_by = next(
            (
                Refusal(refused.code, refused.message)
                for refused in beat.refused
                if refused.incarnation == self._own.incarnation
            ),
            None,
        )
        if begins:
            self.was_connected = True
            self._end_former()
        self.lease.judge(now)
        self.stops.take(
            beat.incarnation, beat.stops_version, beat.stops, now, lives=lives, is_dealt_with=True
        )
        if self.lease.is_held:
            self._end_those_before()
        self._drop_done_releases(beat.incarnation)
        if lives:
            self._refuse_who_lives(beat.heard_seq)
        return Heard.LEASE if begins else Heard.NEWS

    def _end_former(self) -> None:
        """End the stops of processes that were dealt with before; this one tells its own."""
        for process in self._former:
            if process != self.incarnation and not self._may_live(process):
                self.stops.replace(process)

    def _end_those_before(self) -> None:
        """End the stops of silent processes that did not run beside the one that is dealt with.

        What was on its way when its process ended is heard a little later.
        """
        until = self._began_at + self._settings.lost
        for process in self.stops.processes():
            is_silent = process != self.incarnation and process not in self._others
            is_before = is_silent and self.stops.heard_at(process) < until
            if is_before and not self._may_live(process):
                self.stops.replace(process)

    def _may_live(self, process: Incarnation) -> bool:
        """Tell whether a process may be stopped and live, where it cannot be heard.

        A device that was started again without its stop looks the same as another one that took the
        name of one behind a broken cable: a person decides. Of the supervisor there is a person.
        """
        return self.name != SUPERVISOR and self.stops.is_certain(process)

    def _drop_done_releases(self, process: Incarnation) -> None:
        engaged = self.stops.ids_of(process)
        self.releases = {stop: None for stop in self.releases if stop in engaged}

    def _refuse_who_lives(self, echoed: int) -> None:
        """Refuse those that were heard while the one that is dealt with was, too."""
        for other in self._others:
            if _lived_before(other, echoed):
                other.refusal = other.refusal or self._conflict


def _lived_before(other: Other, echoed: int) -> bool:
    return other.proven_after is not None and echoed > other.proven_after
