"""Messages that were not taken in, by the reason."""

from collections.abc import Mapping
from enum import StrEnum


class Drop(StrEnum):
    """Why a message was not taken in."""

    SENDER = "sender"
    """It is not from whom it says, or from nobody who may speak here."""
    OLD = "old"
    """A later one came before, or its process or session is not dealt with."""
    UNEXPECTED = "unexpected"
    """Nobody may say such a thing to this computer."""
    REFUSED = "refused"
    """A command that is not carried out; its sender is told."""


class Drops:
    """Counts them."""

    def __init__(self) -> None:
        """Begin at zero."""
        self._counts = dict.fromkeys(Drop, 0)

    def count(self, why: Drop) -> None:
        """Count one message."""
        self._counts[why] += 1

    @property
    def counts(self) -> Mapping[Drop, int]:
        """Return how many there were, by the reason; read only."""
        return self._counts
