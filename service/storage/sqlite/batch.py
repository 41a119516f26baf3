"""What is written in one transaction: all of it, or nothing."""

from dataclasses import dataclass, field
from typing import TypeAlias

from domain.timebase import Instant
from service.storage.event_rows import EventRow

Key: TypeAlias = tuple[str, str]
"""Kind and name of a kept value."""
Changes: TypeAlias = dict[Key, bytes | None]
"""New values by key; None: kept no longer."""

IDS, OWN = "ids", "own"
"""Kinds that the journal itself uses; those of the core have the names of their records."""


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """The state of the core after a step."""

    step: int
    at: Instant
    state: bytes


@dataclass(frozen=True, slots=True)
class Hole:
    """Steps that were lost, since they could not be written."""

    after_step: int
    """Number of the last step before them."""
    steps: int
    events: int
    from_at: Instant
    to_at: Instant
    reason: str


@dataclass(slots=True)
class Batch:
    """Steps that followed each other, and what they changed."""

    number: int = 0
    """Rises by one per batch, over all runs."""
    first_step: int = 0
    steps: list[bytes] = field(default_factory=list)
    first_at: Instant = 0
    last_at: Instant = 0
    wall_ns: int = 0
    """Wall time of the last step."""
    events: list[EventRow] = field(default_factory=list)
    changes: Changes = field(default_factory=dict)
    checkpoints: list[Checkpoint] = field(default_factory=list)
    ends_run: bool = False
    hole: Hole | None = None
    """Lost after its last step."""
    size: int = 0
    """How much of the backlog it takes, in bytes."""

    @property
    def is_empty(self) -> bool:
        """Tell whether there is nothing to write."""
        return not (self.steps or self.changes or self.checkpoints or self.hole)


@dataclass(frozen=True, slots=True)
class Flight:
    """What is handed to the writer at once, and is one transaction."""

    batches: tuple[Batch, ...]
    must_last: bool
    """Whether it must survive the loss of power when the writer reports success."""
