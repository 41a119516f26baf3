"""Events."""

from collections.abc import Mapping
from dataclasses import dataclass

from domain.timebase import Instant


@dataclass(frozen=True, slots=True)
class Event:
    """Something that was decided or that became known."""

    id: int
    """Rises by one per event."""
    at: Instant
    kind: str
    cause: int | None
    """The event that led to this one; None: it came from outside."""
    actor: str
    data: Mapping[str, object]
