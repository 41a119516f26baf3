"""Reasons as values: why a request is blocked, and what is wrong with a model."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from domain.timebase import Instant

Fact: TypeAlias = bool | int | float | str | None
"""A plain value that needs no conversion to be shown."""


@dataclass(frozen=True, slots=True)
class Blocker:
    """One reason why a mode cannot be entered, a change is rejected, or the robot is in ERROR."""

    code: str
    """Stable, UPPER_SNAKE: an error name (`ESTOP`) or the state of a part (`UNREACHABLE`)."""
    message: str
    path: tuple[str, ...]
    """Parts from the requested one down to the cause; for an error, the signal."""
    value: Fact = None
    threshold: Fact = None
    since: Instant | None = None
    root_cause: bool = True
    refuses: bool = True
    """Whether a request is rejected because of it; False: it is only shown."""
    causes: "tuple[Blocker, ...]" = ()
    """What it follows from; empty: it is a leaf of the tree."""
    condition: str | None = None
    """The text of the condition that is not true; None: it is no condition."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One error or warning in a file."""

    severity: Literal["error", "warning"]
    code: str
    """Stable, UPPER_SNAKE."""
    message: str
    part: str | None = None
    path: tuple[str, ...] = ()
    """Keys from the top of the file to the place; the part name counts as one key."""
    line: int | None = None
    """From 1; None: the model does not come from a file."""
    column: int | None = None
    """From 1."""
