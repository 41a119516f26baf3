"""The computers of a robot: what tells them and their runs apart, and what one knows of another."""

from dataclasses import dataclass
from enum import StrEnum
from typing import NewType

from domain.timebase import Duration, Instant

ComputerName = NewType("ComputerName", str)
"""`supervisor`, or the name of a device in the robot file."""

Incarnation = NewType("Incarnation", str)
"""One run of a process: 32 hexadecimal digits, random."""

Session = NewType("Session", str)
"""32 hexadecimal digits, random; a device carries out only commands of its present session."""

StopId = NewType("StopId", str)
"""One pressing of an emergency stop on one computer; never used twice."""

SUPERVISOR = ComputerName("supervisor")


class DeviceState(StrEnum):
    """How the connection to another computer is."""

    NEVER_SEEN = "never_seen"
    CONNECTED = "connected"
    LATE = "late"
    """Nothing heard for `late_s`; commands still go out."""
    LOST = "lost"
    """Nothing heard, or nothing that we said, for `lost_s`; nothing is commanded."""
    CONFLICT = "conflict"
    """Whoever answers by this name must not be dealt with."""


def computer_words(computer: ComputerName) -> str:
    """Return a computer in words, such as "device arm"."""
    return "the supervisor" if computer == SUPERVISOR else f"device {computer}"


@dataclass(frozen=True, slots=True)
class PeerStop:
    """An emergency stop that one computer tells another of: it is engaged on the one that tells."""

    id: StopId
    by: str
    reason: str
    since: Instant
    """On the clock of this computer."""


@dataclass(frozen=True, slots=True)
class Connection:
    """How the connection to another computer is doing, measured by the messages that pass."""

    heard_at: Instant | None = None
    """When a beat of it last came; None: none has come since the start."""
    round_trip: Duration | None = None
    """From sending a beat to hearing its echo, which waits for the next beat of the other computer;
    None: no echo has come."""
    lost_share: float | None = None
    """Share of the beats of the last seconds that did not come; None: none has come so far."""
    dropped: int = 0
    """Messages of it that were too many or too long, or could not be read."""


@dataclass(frozen=True, slots=True)
class StopView:
    """An emergency stop that is engaged, and where."""

    id: StopId
    computer: ComputerName | None
    """None: this one."""
    by: str
    reason: str
    since: Instant
