"""What the core keeps over a restart of the service: small, plain values by kind and name.

A concern says by `Outbox.keep` and `Outbox.forget` what changed of it. After a restart the input
`Restored` brings the values back. Fields may be added with a default; a stored value of an older
version is read without them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from domain.computers import ComputerName, PeerStop
from domain.findings import Fact
from domain.identifiers import ChangeId, TaskId
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import ParameterValue
from domain.paths.path import Path
from domain.reaction_terms import Arm
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Duration, Instant
from domain.vehicle import VehicleState


@dataclass(frozen=True, slots=True)
class KeptTarget:
    """A requested target that is in force for some part; those below it are derived again."""

    part: PartName
    target: StateAndMode
    order: int
    """Rises with each request: a later one prevails where two concern the same part."""
    staying: Mapping[PartName, LifecycleState] = field(default_factory=dict)
    """Nodes below in which the request was not legal, and the state that each is to keep."""

    @property
    def name(self) -> str:
        """Return its name: two modes of a system may name different parts, and both be in force."""
        return str(self.order)


@dataclass(frozen=True, slots=True)
class KeptEffectiveTarget:
    """A target that is in force for a system instead of the requested one."""

    part: PartName
    target: StateAndMode
    rule: str | None
    """Name of the rule or reaction that set it; None: it has none."""
    order: int
    """Rises with each displacement: a later one prevails where two concern the same part."""
    after: int
    """Order of the last request before it: parts of which something was requested later do not
    inherit it."""
    cause: int
    """Id of the event that recorded it."""
    since: Instant
    staying: Mapping[PartName, LifecycleState] = field(default_factory=dict)
    """Nodes below to which it does not apply, and the state that each is to keep."""
    because: str = "rule"
    """Who set it: `rule`, `invariant` or `reaction`."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return str(self.order)


@dataclass(frozen=True, slots=True)
class KeptChange:
    """A change that has not ended."""

    id: ChangeId
    part: PartName
    started_at: Instant
    cause: int
    """Id of the event that recorded the request."""
    mode: str | None = None
    transition: Transition | None = None
    parameters: Mapping[str, ParameterValue] | None = None
    """Of these three, what was requested; the others are None."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.id


@dataclass(frozen=True, slots=True)
class KeptEmergencyStop:
    """The emergency stop of this computer."""

    engaged: bool
    by: str
    reason: str
    since: Instant
    id: str = ""
    """As peers know it; empty: it is not engaged, or an older release kept it."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind; there is one."""
        return ""


@dataclass(frozen=True, slots=True)
class KeptPeerStops:
    """Emergency stops that were engaged on another computer when that was heard last."""

    computer: ComputerName
    stops: tuple[PeerStop, ...]

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.computer


@dataclass(frozen=True, slots=True)
class KeptError:
    """An error of a signal that an operator has yet to acknowledge."""

    signal: str
    error: str
    since: Instant
    """When it was raised."""
    message: str
    """What was measured."""
    part: PartName | None = None
    """Whose error it is; None: the robot's own."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.error if self.part is None else f"{self.part}.{self.error}"


@dataclass(frozen=True, slots=True)
class KeptUnacknowledged:
    """An error that was raised, whether it is still on or not, and that nobody acknowledged."""

    part: PartName | None
    """None: the robot's own."""
    error: str
    message: str
    """What was found when it was raised."""
    since: Instant
    """When it was raised."""
    value: Fact = None
    threshold: Fact = None

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return _of_part(self.part, self.error)


@dataclass(frozen=True, slots=True)
class KeptShelf:
    """An error that somebody shelved for a time."""

    part: PartName | None
    """None: the robot's own."""
    error: str
    until: Instant
    """As long as the service runs; `KeptClock` tells how long it did not."""
    reason: str
    by: str

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return _of_part(self.part, self.error)


@dataclass(frozen=True, slots=True)
class KeptClock:
    """The time up to which the service ran, for what does not run down while it is down."""

    at: Instant

    @property
    def name(self) -> str:
        """Return its name among those of its kind; there is one."""
        return ""


@dataclass(frozen=True, slots=True)
class KeptFailedChange:
    """The last change of a part that ended did so without success."""

    part: PartName
    change: ChangeId
    message: str
    """How it ended, in words."""
    status: str
    """`failed` or `timed_out`."""
    since: Instant
    """When the first change ended so since the last success."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.part


@dataclass(frozen=True, slots=True)
class KeptReport:
    """An error of a part that somebody reported, and that is not over."""

    part: PartName
    error: str
    message: str
    value: Fact
    since: Instant
    """When it was reported first."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return f"{self.part}.{self.error}"


@dataclass(frozen=True, slots=True)
class KeptHold:
    """A hold that somebody set."""

    owner: str
    reason: str
    by: str
    since: Instant

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.owner


@dataclass(frozen=True, slots=True)
class KeptReaction:
    """How a reaction of the model stands, if that is more than idle."""

    part: PartName
    reaction: str
    arm: Arm | None = None
    """What an operator said; None: it is as the model says."""
    since: Instant | None = None
    """Since when it acts, or has acted too often; None: it does neither."""
    is_exhausted: bool = False
    is_acknowledged: bool = False
    """It ends once its condition is no longer true."""
    escalated: bool = False
    """It did not have its effect in time, and so another one is called for."""
    used: tuple[Duration, ...] = ()
    """How long ago it acted, when this was kept: while the service is down, no time passes."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.reaction


@dataclass(frozen=True, slots=True)
class KeptBound:
    """How often something happened that may happen only so often within a time."""

    kind: str
    """`rule`: that one acts; `rule_return`, `invariant_return`: that a part returns."""
    bounded: str
    """Which rule, as `SYSTEM.RULE`, or which part."""
    ages: tuple[Duration, ...] = ()
    """How long ago it happened, when this was kept: while the service is down, no time passes."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return f"{self.kind}:{self.bounded}"


@dataclass(frozen=True, slots=True)
class KeptProcess:
    """How the process of a node stands, if that is more than that it may run."""

    node: PartName
    is_stopped: bool = False
    """Somebody asked for its end."""
    given_up: str = ""
    """How it ended when it was given up, in words; empty: it was not."""
    ages: tuple[Duration, ...] = ()
    """How long ago it was started, when this was kept: while the service is down, no time
    passes."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.node


@dataclass(frozen=True, slots=True)
class KeptTask:
    """A task as it was submitted; its progress is kept apart, since that changes often."""

    id: TaskId
    path: Path
    controller: str
    speed_mps: float
    start_index: int
    created_at: Instant
    cause: int
    """Id of the event that recorded the request."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.id


@dataclass(frozen=True, slots=True)
class KeptProgress:
    """How far a task got, and how it ended."""

    task: TaskId
    has_run: bool
    target_index: int
    distance_m: float
    left_out_m: float
    cross_track_error_m: float | None = None
    ended_as: str | None = None
    """Its last status; None: it has not ended."""
    reason: str | None = None
    """How it ended; None: it has not, or there is nothing more to say."""
    ended_at: Instant | None = None
    seen: VehicleState | None = None
    """The vehicle when it had got so far: what it rolls thereafter, unseen, is driven."""

    @property
    def name(self) -> str:
        """Return its name among those of its kind."""
        return self.task


def _of_part(part: PartName | None, error: str) -> str:
    """Return the name of an error among those of all parts; None: the robot's own."""
    return error if part is None else f"{part}.{error}"


Kept: TypeAlias = (
    KeptTarget
    | KeptEffectiveTarget
    | KeptChange
    | KeptEmergencyStop
    | KeptPeerStops
    | KeptError
    | KeptUnacknowledged
    | KeptShelf
    | KeptClock
    | KeptFailedChange
    | KeptReport
    | KeptHold
    | KeptReaction
    | KeptBound
    | KeptProcess
    | KeptTask
    | KeptProgress
)


@dataclass(frozen=True, slots=True)
class Keeping:
    """What is kept of one thing changed."""

    kind: type[Kept]
    name: str
    value: Kept | None
    """None: it is forgotten."""
