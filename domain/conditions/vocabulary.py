"""What conditions can name on a robot: its parts, signals and errors, with their types."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, auto


class Kind(Enum):
    """Types of facts."""

    NUMBER = auto()
    BOOLEAN = auto()
    WORD = auto()


@dataclass(frozen=True, slots=True)
class Terms:
    """The values that a fact can have."""

    kind: Kind
    minimum: float | None = None
    """Smallest number; None: there is none."""
    maximum: float | None = None
    words: tuple[str, ...] | None = None
    """The words that it can be; None: any."""
    code: str = "UNKNOWN_WORD"
    """Of the finding about a word that it can never be."""


@dataclass(frozen=True, slots=True)
class PartTerms:
    """What can be said of one part."""

    is_node: bool
    modes: tuple[str, ...] = ()
    parameters: Mapping[str, Terms | None] = field(default_factory=dict)
    """Of the modes of a node; None: an array, which cannot be compared."""
    errors: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What conditions can name."""

    parts: Mapping[str, PartTerms]
    signals: Mapping[str, Terms]
    errors: tuple[str, ...]
    """Of the robot."""
    is_complete: bool = True
    """All signals and errors are known; False: there may be more, as in a robot file that was not
    given.
    """
