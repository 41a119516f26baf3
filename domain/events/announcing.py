"""Events of the announcing of errors: shelving and chattering."""

from dataclasses import dataclass

from domain.events.event import Event, because
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName


@dataclass(frozen=True, slots=True)
class ErrorShelved(Event):
    """An error is not announced for a time; its state, its bit and its reactions stay."""

    kind = "error.shelved"
    is_input = True

    error: str
    for_s: float
    reason: str
    part: PartName | None = None
    """None: the robot's own."""

    def _words(self) -> str:
        name = ErrorKey(self.part, self.error).name
        return because(f"{name} shelved for {duration_words(self.for_s)}", self.reason)


@dataclass(frozen=True, slots=True)
class ErrorUnshelved(Event):
    """An error is announced again: its time is up, or somebody asked for that."""

    kind = "error.unshelved"
    is_input = True

    error: str
    part: PartName | None = None
    """None: the robot's own."""

    def _words(self) -> str:
        return f"{ErrorKey(self.part, self.error).name} is no longer shelved"


@dataclass(frozen=True, slots=True)
class ErrorChattering(Event):
    """An error was raised and cleared more than 5 times in 10 min, both counted."""

    kind = "error.chattering"

    error: str
    clear_for_s: float | None
    """For how long its cause would have to be gone before it clears, to be calm."""
    part: PartName | None = None
    """None: the robot's own."""

    def _words(self) -> str:
        return f"{ErrorKey(self.part, self.error).name}: {chatter_words(self.clear_for_s)}"


def chatter_words(clear_for_s: float | None) -> str:
    """Return that an error chatters, and what would calm it.

    Args:
        clear_for_s: For how long its cause would have to be gone, in s; None: that is not known.
    """
    what = "it changed more than 5 times in 10 min"
    return what if clear_for_s is None else f"{what}; clear_for_s: {clear_for_s:g} would calm it"


def duration_words(time_s: float) -> str:
    """Return a time in s as an operator says it, such as `90 s`, `10 min` or `1.5 h`."""
    for unit, length_s in (("h", 3_600.0), ("min", 60.0)):
        if time_s >= length_s and (time_s / length_s * 4).is_integer():
            return f"{time_s / length_s:g} {unit}"
    return f"{time_s:g} s"
