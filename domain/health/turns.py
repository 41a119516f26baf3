"""A turn of an error: it is raised, or it ends."""

from typing import NamedTuple

from domain.snapshot import ErrorKey
from domain.timebase import Instant


class Turn(NamedTuple):
    """An error was raised, or ended."""

    key: ErrorKey
    raised: bool
    at: Instant
