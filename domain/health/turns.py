"""A turn of an error: it is raised, or it ends."""

from typing import NamedTuple

from domain.snapshot import ErrorKey
from domain.timebase import Instant


class Turn(NamedTuple):
    """An error was raised, or ended."""

    key: ErrorKey
    raised: bool
    at: Instant
    gone: Instant | None = None
    """Of an end: when its cause was gone, which may be earlier; None: just then."""
