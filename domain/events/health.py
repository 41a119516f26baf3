"""Events of signals, errors, the emergency stop and the state of the robot."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from domain.computers import ComputerName, StopId, computer_words
from domain.events.event import Event, because
from domain.findings import Fact
from domain.inputs import SignalValue
from domain.snapshot import ErrorKey, SystemState
from domain.state_and_mode import PartName


@dataclass(frozen=True, slots=True)
class SignalRead(Event):
    """One or more readings arrived together."""

    kind = "signal.read"
    is_input = True
    is_notable = False

    source: str
    values: Mapping[str, SignalValue]

    def _words(self) -> str:
        values = ", ".join(f"{signal} {value}" for signal, value in self.values.items())
        return f"{values} (source {self.source})"


@dataclass(frozen=True, slots=True)
class SignalNotRead(Event):
    """A source gives no reading of a signal, which becomes stale unless another one does."""

    kind = "signal.not_read"
    is_input = True
    is_notable = False

    signal: str
    source: str
    reason: str

    def _words(self) -> str:
        return because(f"no reading of {self.signal} from {self.source}", self.reason)


@dataclass(frozen=True, slots=True)
class SignalPending(Event):
    """A signal is bad; an error follows unless it recovers in time."""

    kind = "signal.pending"
    is_notable = False

    signal: str
    error: str

    def _words(self) -> str:
        return f"{self.signal} is bad; {self.error} follows if it lasts"


@dataclass(frozen=True, slots=True)
class SignalSettled(Event):
    """A signal recovered, or became stale, before an error was raised."""

    kind = "signal.settled"
    is_notable = False

    signal: str
    error: str
    stale: bool

    def _words(self) -> str:
        if self.stale:
            return f"{self.signal} is stale; the time of {self.error} begins anew"
        return f"{self.signal} recovered; no {self.error}"


@dataclass(frozen=True, slots=True)
class SignalSkewed(Event):
    """The clock of a signal's sender differs from ours by more than 1 s."""

    kind = "signal.skewed"
    is_notable = False

    signal: str

    def _words(self) -> str:
        return f"the clock of the sender of {self.signal} differs from ours by more than 1 s"


@dataclass(frozen=True, slots=True)
class SignalLimitsChanged(Event):
    """Other limits of a signal are in force, since a part is in another mode."""

    kind = "signal.limits_changed"
    is_notable = False

    signal: str
    because: str | None
    """Part and mode, as the robot file says, or `default`; None: no limits are in force."""
    above: float | None = None
    below: float | None = None

    def _words(self) -> str:
        limits = ((word, getattr(self, word)) for word in ("above", "below"))
        told = [f"{word} {limit:g}" for word, limit in limits if limit is not None]
        bad = f"{self.signal} is bad {told[0]}" if told else f"no value of {self.signal} is bad"
        return because(bad, self.because or "none of its limits applies")


_TOLD_ALREADY = frozenset({"UNREACHABLE", "CHANGE_FAILED"})
"""Errors of parts that follow at once from an event that a short list shows."""


@dataclass(frozen=True, slots=True)
class ErrorRaised(Event):
    """An error of the robot or of a part is raised."""

    kind = "error.raised"
    hidden = frozenset({"of_device"})

    error: str
    message: str
    value: Fact
    threshold: Fact
    part: PartName | None = None
    """None: the robot's own."""
    root_cause: bool = True
    """No other error explains it."""
    silenced: bool = False
    """It is shelved, or the model suppresses it."""
    of_device: bool = field(default=False, kw_only=True)
    """The part is a device, of which another event tells."""

    def _words(self) -> str:
        return f"{ErrorKey(self.part, self.error).name}: {self.message}"

    @property
    def notable(self) -> bool:
        """Tell whether it is announced, and no other event of a short list says so or explains it.

        An error that is silenced still sets its bit, which other events tell.
        """
        is_told = self.of_device or self.silenced
        return not is_told and _is_told_by_itself(self.part, self.error, self.root_cause)


@dataclass(frozen=True, slots=True)
class ErrorCleared(Event):
    """An error of the robot or of a part is cleared."""

    kind = "error.cleared"
    hidden = frozenset({"of_device"})

    error: str
    part: PartName | None = None
    """As in `error.raised`."""
    root_cause: bool = True
    """No other error explained it."""
    silenced: bool = False
    """As in `error.raised`."""
    of_device: bool = field(default=False, kw_only=True)
    """As in `error.raised`."""

    def _words(self) -> str:
        return f"{ErrorKey(self.part, self.error).name} cleared"

    @property
    def notable(self) -> bool:
        """As of `error.raised`."""
        is_told = self.of_device or self.silenced
        return not is_told and _is_told_by_itself(self.part, self.error, self.root_cause)


def _is_told_by_itself(part: PartName | None, error: str, root_cause: bool) -> bool:
    return part is None or (root_cause and error not in _TOLD_ALREADY)


@dataclass(frozen=True, slots=True)
class ErrorReported(Event):
    """Somebody reports an error of a part, or that it is over."""

    kind = "error.reported"
    is_input = True

    part: PartName
    error: str
    active: bool
    message: str
    value: Fact

    def _words(self) -> str:
        name = ErrorKey(self.part, self.error).name
        return because(f"{name} reported", self.message) if self.active else f"{name} reported over"


@dataclass(frozen=True, slots=True)
class PropagationNotSeen(Event):
    """An error should have led to another one by now, and did not: a detection may be broken."""

    kind = "propagation.not_seen"

    error: str
    part: PartName
    cause_error: str
    cause_part: PartName | None
    """None: it is an error of the robot itself."""
    within_s: float

    def _words(self) -> str:
        cause = ErrorKey(self.cause_part, self.cause_error).name
        name = ErrorKey(self.part, self.error).name
        return f"{cause} has been on for {self.within_s:g} s without {name}"


@dataclass(frozen=True, slots=True)
class ErrorAcknowledged(Event):
    """An error is acknowledged."""

    kind = "error.acknowledged"
    is_input = True

    error: str
    part: PartName | None = None
    """None: the robot's own."""

    def _words(self) -> str:
        return f"{ErrorKey(self.part, self.error).name} acknowledged"


@dataclass(frozen=True, slots=True)
class EmergencyStopEngaged(Event):
    """The emergency stop is engaged on this computer."""

    kind = "emergency_stop.engaged"
    is_input = True

    reason: str

    def _words(self) -> str:
        return because("emergency stop engaged", self.reason)


@dataclass(frozen=True, slots=True)
class EmergencyStopReleased(Event):
    """The emergency stop of this computer is released."""

    kind = "emergency_stop.released"
    is_input = True

    optional = frozenset({"still_engaged_at"})

    reason: str
    still_engaged_at: tuple[ComputerName, ...] | None = None
    """Other computers of the robot on which a stop is engaged; None: there is none."""

    def _words(self) -> str:
        if not self.still_engaged_at:
            return "emergency stop released"
        where = ", ".join(map(computer_words, self.still_engaged_at))
        return f"emergency stop released here; one is still engaged at {where}"


@dataclass(frozen=True, slots=True)
class PeerStopEngaged(Event):
    """An emergency stop is engaged on another computer of the robot, and so stops all of it."""

    kind = "emergency_stop.peer_engaged"
    is_input = True

    computer: ComputerName
    stop: StopId
    by: str
    """Who engaged it there."""
    reason: str

    def _words(self) -> str:
        by = f" by {self.by}" if self.by else ""
        engaged = f"emergency stop engaged at {computer_words(self.computer)}{by}"
        return because(engaged, self.reason)


@dataclass(frozen=True, slots=True)
class PeerStopReleased(Event):
    """An emergency stop on another computer of the robot is released."""

    kind = "emergency_stop.peer_released"
    is_input = True

    computer: ComputerName
    stop: StopId

    def _words(self) -> str:
        return f"emergency stop at {computer_words(self.computer)} released"


@dataclass(frozen=True, slots=True)
class StopReleaseAsked(Event):
    """Another computer of the robot is asked to release emergency stops that are engaged there."""

    kind = "emergency_stop.release_asked"
    is_input = True

    computer: ComputerName
    stops: tuple[StopId, ...]

    def _words(self) -> str:
        return f"{computer_words(self.computer)} asked to release its emergency stop"


@dataclass(frozen=True, slots=True)
class EmergencyStopStandstill(Event):
    """The vehicle is at standstill after the emergency stop; told again if it moved meanwhile."""

    kind = "emergency_stop.standstill"

    def _words(self) -> str:
        return "the vehicle is at standstill after the emergency stop"


@dataclass(frozen=True, slots=True)
class SystemStateChanged(Event):
    """The state of the robot or its errors changed."""

    kind = "system_state.changed"

    state: SystemState
    was: SystemState
    errors: tuple[str, ...]
    error_code: int

    def _words(self) -> str:
        step = self.state if self.state is self.was else f"{self.was} -> {self.state}"
        return because(str(step), ", ".join(self.errors))
