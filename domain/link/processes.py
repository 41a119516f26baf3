"""Other processes that answer by the name of a computer, beside the one that is dealt with."""

from collections.abc import Iterator
from dataclasses import dataclass

from domain.computers import Incarnation
from domain.link.messages import Refused
from domain.link.terms import Refusal
from domain.timebase import Duration, Instant

_MAX_OTHERS = 8
"""Processes that are remembered at most; of more, those that were heard last."""


@dataclass(slots=True)
class Other:
    """A process that is not dealt with: it waits, or it is refused."""

    incarnation: Incarnation
    first_heard_at: Instant
    heard_at: Instant
    seq: int = 0
    refusal: Refusal | None = None
    """None: it waits until the one that is dealt with was silent for long enough."""
    proven_after: int | None = None
    """The last own beat that was sent when this process was known to live; None: it is not."""


class Others:
    """The other processes of one name; each is forgotten once it is silent."""

    def __init__(self, forgotten_after: Duration) -> None:
        """Begin without any.

        Args:
            forgotten_after: How long a process may be silent.
        """
        self._forgotten_after = forgotten_after
        self._known: dict[Incarnation, Other] = {}

    def __iter__(self) -> Iterator[Other]:
        """Iterate over them, that which was heard first comes first."""
        return iter(self._known.values())

    def __contains__(self, process: Incarnation) -> bool:
        """Tell whether a process was heard not long ago."""
        return process in self._known

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._known)

    def meet(self, process: Incarnation, now: Instant) -> Other:
        """Return what is known of a process that is heard now."""
        other = self._known.get(process)
        if other is None:
            if len(self._known) == _MAX_OTHERS:
                self.forget(min(self, key=lambda known: known.heard_at).incarnation)
            other = self._known[process] = Other(process, now, now)
        return other

    def forget(self, process: Incarnation) -> None:
        """Forget a process; it is dealt with."""
        self._known.pop(process, None)

    def forget_silent(self, now: Instant) -> None:
        """Forget all that were silent for long enough."""
        for other in list(self):
            if now >= other.heard_at + self._forgotten_after:
                self.forget(other.incarnation)

    def wake_at(self) -> Instant | None:
        """Return when the next is forgotten; None: there is none."""
        heard = [other.heard_at for other in self]
        return min(heard) + self._forgotten_after if heard else None

    def refused(self) -> tuple[Refused, ...]:
        """Return those that are refused, as they are told."""
        return tuple(
            Refused(other.incarnation, *other.refusal)
            for other in self
            if other.refusal is not None
        )
