"""The port of storage: what the core took and decided is written down, and found again.

The loop never waits for a disk: `note` returns at once, and only who must answer for what is kept
awaits `commit`. `tests/conformance/test_journal.py` specifies what every adapter must do.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Protocol, TypeAlias

from domain.inputs import Input, Restored
from domain.outbox import Outputs
from domain.state_and_mode import PartName
from domain.timebase import Instant

Plain: TypeAlias = bool | int | float | str | Sequence["Plain"] | Mapping[str, "Plain"] | None
"""What JSON can hold."""


@dataclass(frozen=True, slots=True)
class Boot:
    """A run of the service: what its core was made of, so that a replay can make it again."""

    epoch: str
    """Unique name of the run."""
    version: str
    """Version of Pilothouse."""
    started_at: Instant
    wall_at: datetime
    """`started_at` as UTC, as the system clock was set then."""
    model: str
    """Text of the model file."""
    robot: str
    """Text of the robot file; empty: there is none."""


@dataclass(frozen=True, slots=True)
class Found:
    """What opening a journal found."""

    restored: Restored
    """The first input of this run."""
    is_new: bool = True
    """Whether there was no earlier run."""
    ended_at: datetime | None = None
    """When the last entry of the earlier run was written; None: there was none."""
    epochs: Mapping[str, int] | None = None
    """Earlier runs that are still in the log, by epoch, with the id of the last event of each."""
    own: Mapping[str, Plain] | None = None
    """What the service kept by `keep`."""
    left_out: tuple[str, ...] = ()
    """What was kept and cannot be taken back, in words."""


@dataclass(frozen=True, slots=True)
class Step:
    """One input that the core took, and what followed."""

    at: Instant
    given: Input
    is_late: bool
    """Whether it was late by our own fault: `Onboard.take_in`, not `handle`."""
    outputs: Outputs


@dataclass(frozen=True, slots=True)
class LogStatus:
    """The extent of one log."""

    from_at: datetime | None
    to_at: datetime | None
    bytes: int


@dataclass(frozen=True, slots=True)
class StorageStatus:
    """How storage is doing."""

    path: str
    """The folder, or `:memory:`."""
    bytes: int
    free_bytes: int | None
    reason: str | None
    """Why storage is degraded; None: it is not."""
    library_version: str
    boot: int
    logs: Mapping[str, LogStatus]
    """By name: `inputs` and `events`."""
    lost_inputs: int = 0
    lost_events: int = 0
    """What this run could not write down."""


ANNOUNCED = "announced"
"""Under this name `Found.own` has the last announcements: a list."""

NOTHING_KEPT = StorageStatus(":memory:", 0, None, None, "", 1, {})
"""Status where nothing is kept, as in a simulation."""


@dataclass(frozen=True, slots=True)
class EventQuery:
    """Which events of the log are wanted; None: any."""

    after: int | None = None
    """Only ids above, and of these the first; without it the newest are returned."""
    before: int | None = None
    """Only ids below."""
    from_at: datetime | None = None
    """Not before this moment."""
    to_at: datetime | None = None
    """Not after this moment."""
    kind: str | None = None
    """A kind, a prefix such as `change`, or a pattern with `*`: see `KindPattern`."""
    part: PartName | None = None
    """Events whose data name this part."""
    actor: str | None = None
    """Label of the actor."""
    limit: int = 100


@dataclass(frozen=True, slots=True)
class StoredEvent:
    """An event as it was written down, readable without the class that it was made from."""

    id: int
    boot: int
    epoch: str
    at: Instant
    wall_at: datetime
    """`at` as UTC, as the system clock was set when the event was written down."""
    kind: str
    cause: int | None
    actor: str
    data: Mapping[str, Plain]
    """As clients see it."""
    words: str
    notable: bool
    """Whether a short list for operators shows this event."""


class Journal(Protocol):
    """Keeps what must not be forgotten."""

    @property
    def found(self) -> Found:
        """Return what was there when the journal was opened."""
        ...

    @property
    def boot(self) -> Boot:
        """Return this run."""
        ...

    @property
    def is_durable(self) -> bool:
        """Tell whether what is committed survives this process."""
        ...

    @property
    def fault(self) -> str | None:
        """Return why storage is degraded; None: it is not. Cheap, unlike `status`."""
        ...

    def note(self, step: Step) -> None:
        """Write a step down soon, all of it or nothing; return at once, and never raise."""
        ...

    def keep(self, name: str, value: Plain) -> None:
        """Keep a value of the service itself, such as the state of a simulated robot."""
        ...

    async def announce(self, what: Plain, patience_s: float) -> bool:
        """Put on disk what is about to be done; return whether it is there, in that time.

        It proves that storage works now. It waits for nothing that was noted or kept.

        Raises:
            StorageDegradedError: Storage fails: it will not be, until it works again.
        """
        ...

    @property
    def wants_checkpoint(self) -> bool:
        """Tell whether a replay could not go on from what was written down lately.

        So at the start, after a hole, with each new file of the log, and every few minutes.
        """
        ...

    @property
    def last_step(self) -> int:
        """Return the number of the step that was noted last."""
        ...

    def checkpoint(self, step: int, at: Instant, state: bytes) -> None:
        """Write down the whole state of the core as it was after a step."""
        ...

    async def commit(self, patience_s: float) -> bool:
        """Wait until all that was noted before is on disk; return whether it is, in that time.

        Something is written in any case: success proves that storage works now.

        Raises:
            StorageDegradedError: Storage fails: it will not be, until it works again.
        """
        ...

    def status(self) -> StorageStatus:
        """Return how storage is doing, without touching a disk."""
        ...

    async def events(self, query: EventQuery) -> Sequence[StoredEvent]:
        """Return events in the order of their ids, also those of earlier runs.

        Raises:
            StorageDegradedError: They cannot be read.
        """
        ...

    async def close(self) -> None:
        """Write down what is noted, note that the run ended, and release the folder."""
        ...
