"""What conditions are evaluated over: one observation for each subject, and the reasons behind."""

from dataclasses import dataclass
from typing import Protocol

from domain.conditions.tree import Comparison, Subject, Value
from domain.findings import Blocker
from domain.timebase import Instant


@dataclass(frozen=True, slots=True)
class Observation:
    """What is known of a subject at one moment."""

    value: Value | None = None
    """The value, or the last known one; None: there is none, such as no mode."""
    doubt: str = ""
    """Why the value is not known, as a phrase that follows the subject: `is stale`; empty: it is
    known.
    """
    since: Instant | None = None
    """Since when it is so; None: that is not recorded."""
    unit: str = ""
    """Unit of the value, for messages."""


class Facts(Protocol):
    """What is known of the robot at one moment."""

    def observe(self, subject: Subject) -> Observation:
        """Return what is known of a subject; one that does not exist is in doubt."""
        ...

    def why(self, leaf: Comparison) -> tuple[Blocker, ...]:
        """Return why a comparison that is not true is so; empty: nothing explains it further."""
        ...
