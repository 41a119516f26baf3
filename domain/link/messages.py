"""What the computers of a robot say to each other.

A message that is lost is mended by a later one: each beat tells everything about the connection,
and each second a report tells everything about the nodes. Nothing is ordered by time: `seq` rises
within an incarnation.

Reading ignores unknown fields, and fields may be added with a default: a device of the next minor
release understands a supervisor of this one.
"""

from dataclasses import dataclass
from typing import TypeAlias

from domain.commands import NodeCommand
from domain.computers import ComputerName, Incarnation, Session, StopId
from domain.inputs import (
    CheckpointReport,
    ErrorReport,
    NodeAnswer,
    NodeReport,
    ReactionReport,
    Readings,
    SourceFault,
)
from domain.timebase import Duration

PROTOCOL = 1
"""Version of what follows; the newer of two computers speaks the older one's."""


@dataclass(frozen=True, slots=True)
class Terms:
    """What two computers must agree on before one commands the other."""

    model: str
    """Fingerprint of the model, over what is parsed and not over the text."""
    ownership: str
    """Fingerprint of which device owns which parts, and of what each does when cut off."""
    protocol: int = PROTOCOL
    """Newest version that the sender speaks."""
    version: str = ""
    """Of Pilothouse, for people."""


@dataclass(frozen=True, slots=True)
class EngagedStop:
    """An emergency stop that is engaged on the computer that says so."""

    id: StopId
    by: str
    reason: str
    age: Duration
    """How long it has been engaged; the clocks of two computers have nothing to do with each
    other."""


@dataclass(frozen=True, slots=True)
class StopsPassedOn:
    """What one process of another computer said last of its stops, passed on by the supervisor.

    Every computer tells every other one itself; two devices whose connection to each other is
    broken learn of it so.
    """

    computer: ComputerName
    incarnation: Incarnation
    version: int
    """Its `stops_version`."""
    stops: tuple[EngagedStop, ...]
    is_dealt_with: bool
    """Whether it is the process that answers for its computer; no other one counts beside it that
    is not passed on as well."""


@dataclass(frozen=True, slots=True)
class Refused:
    """An incarnation of the addressed computer that the sender does not deal with, and why."""

    incarnation: Incarnation
    code: str
    """`DEVICE_CONFLICT`, `SECOND_SUPERVISOR`, `OTHER_PROTOCOL`, `OTHER_MODEL`, `OTHER_OWNERSHIP` or
    `UNKNOWN_DEVICE`."""
    message: str


@dataclass(frozen=True, slots=True)
class Beat:
    """A sign of life for one other computer, and all that must not wait.

    Sent every 0.1 s and at once when a stop was engaged or released. Lost ones are not sent again.
    """

    sender: ComputerName
    incarnation: Incarnation
    seq: int
    terms: Terms
    heard: Incarnation | None = None
    """Incarnation of the addressed computer that the sender deals with; None: not yet any."""
    heard_seq: int = 0
    """Highest `seq` of a beat of it; that is the echo."""
    session: Session | None = None
    """From a device: the present one. From the supervisor: the one that its commands carry."""
    renew: Session | None = None
    """From the supervisor: a session that the device is to replace, since the device was lost."""
    autonomous: bool = False
    """From a device: it acts on its own, as `offline` of the robot file says."""
    stops: tuple[EngagedStop, ...] = ()
    """All stops that are engaged on the sender."""
    stops_version: int = 0
    """Rises with each change of `stops`."""
    heard_stops: int = 0
    """The last `stops_version` of the addressed computer that was taken in."""
    releases: tuple[StopId, ...] = ()
    """Stops of the addressed computer that a person released at the sender."""
    refused: tuple[Refused, ...] = ()
    passed_on: tuple[StopsPassedOn, ...] = ()
    """From the supervisor: of computers on which a stop was engaged since it started; at once when
    that changed, and else each second."""


Told: TypeAlias = (
    NodeReport
    | NodeAnswer
    | Readings
    | SourceFault
    | ErrorReport
    | CheckpointReport
    | ReactionReport
)
"""What a device tells the supervisor of its nodes, signals and reactions."""


@dataclass(frozen=True, slots=True)
class Report:
    """What a device tells of its parts: at once what changed, and each second everything.

    `seq` counts reports without a gap. Stamps of readings are relative to the sending of the
    report, and so negative: the clocks of two computers have nothing to do with each other.
    """

    sender: ComputerName
    incarnation: Incarnation
    seq: int
    items: tuple[Told, ...]
    complete: bool = False
    """Whether it leaves nothing out: of a node or signal that is not in it, nothing is known."""
    session: Session | None = None
    """Of the device when it was made; one of before a loss is out of date."""
    piece: int = 1
    """Of a report that is too long for one message: which piece this is, from 1. All pieces have
    one `seq`, and none of them is `complete`."""
    pieces: int = 1
    """Into how many it was cut."""
    complete_together: bool = False
    """Of a piece: whether all pieces together leave nothing out."""


@dataclass(frozen=True, slots=True)
class NodeOrder:
    """A command of the supervisor to a node of the addressed device."""

    sender: ComputerName
    incarnation: Incarnation
    seq: int
    session: Session
    command: NodeCommand
    heard_seq: int = 0
    """Highest `seq` of a beat of the device: it knows when it sent that, and so how old the command
    is at most. Commands may be held up while beats get through."""


Message: TypeAlias = Beat | Report | NodeOrder
