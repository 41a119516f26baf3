"""How steps and kept values are written down as bytes; the seam to the codec of records."""

from typing import Protocol

from domain.kept import Kept
from service.storage.journal import Step


class Records(Protocol):
    """Writes values of the core as bytes, and reads them back."""

    def step(self, step: Step) -> bytes:
        """Return a step as one line of JSON."""
        ...

    def kind(self, kind: type[Kept]) -> str:
        """Return the stable name of a kind of kept values."""
        ...

    def kept(self, value: Kept) -> bytes:
        """Return a kept value as JSON."""
        ...

    def restored(self, text: bytes) -> Kept:
        """Return the value that `kept` was given, or one of another version.

        Raises:
            PilothouseError: It is no such value.
        """
        ...
