"""Reasons as values: why something cannot be done, and what is wrong with a model."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from domain.timebase import Instant

Fact: TypeAlias = bool | int | float | str | None
"""A plain value that can be shown as it is."""


@dataclass(frozen=True, slots=True)
class Blocker:
    """One reason why a mode cannot be entered, a change is refused, or the robot is in ERROR."""

    code: str
    """Stable, UPPER_SNAKE: an error name (`ESTOP`) or the state of a part (`UNREACHABLE`)."""
    message: str
    path: tuple[str, ...]
    """From the asked part down to where the reason lies; for an error, the signal."""
    value: Fact = None
    threshold: Fact = None
    since: Instant | None = None
    root_cause: bool = True


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing wrong, or at least odd, in a model file."""

    severity: Literal["error", "warning"]
    code: str
    """Stable, UPPER_SNAKE."""
    message: str
    part: str | None = None
    path: tuple[str, ...] = ()
    """Keys from the top of the file to the place, the part name being one key."""
    line: int | None = None
    """From 1; None where the model does not come from a file."""
    column: int | None = None
    """From 1."""
