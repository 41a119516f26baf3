"""The base of all events, and their place in the log.

An event is emitted with `Outbox.emit`, and read by its class and fields. What clients see of it
follows from the class: `kind`, `data`, the sentence for an operator in `words`, and whether that
belongs in a short list (`notable`).
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import Enum
from typing import ClassVar

from domain.actor import Actor
from domain.state_and_mode import StateAndMode
from domain.timebase import Instant


class Event:
    """Something that was decided, or that became known."""

    __slots__ = ()

    kind: ClassVar[str]
    """Its name for clients, such as `change.succeeded`."""
    is_input: ClassVar[bool] = False
    """It came from outside or from the clock; recorded once something follows from it."""
    optional: ClassVar[frozenset[str]] = frozenset()
    """Fields that `data` leaves out while they are None."""
    hidden: ClassVar[frozenset[str]] = frozenset()
    """Fields that `data` never has."""
    is_notable: ClassVar[bool] = True
    """Whether a short list for operators has events of this kind."""

    @property
    def words(self) -> str:
        """Return what happened, as one sentence for an operator."""
        return self._words()

    def _words(self) -> str:
        raise NotImplementedError

    @property
    def notable(self) -> bool:
        """Tell whether a short list for operators has this event."""
        return self.is_notable

    @classmethod
    def data_keys(cls) -> tuple[str, ...]:
        """Return the keys of `data`, in order."""
        return _keys(cls)

    def data(self) -> dict[str, object]:
        """Return the fields as clients see them: labels, texts, numbers, lists and mappings."""
        shown = {}
        for name in _keys(type(self)):
            value = getattr(self, name)
            if value is not None or name not in self.optional:
                shown[name] = _plain(value)
        return shown


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """An event in its place in the log."""

    id: int
    """Rises by one per event."""
    at: Instant
    cause: int | None
    """The event that led to this one; None: it came from outside, or from the clock."""
    actor: Actor
    """Who asked for it."""
    event: Event

    @property
    def kind(self) -> str:
        """Return the name of its kind for clients."""
        return self.event.kind

    @property
    def data(self) -> Mapping[str, object]:
        """Return the fields of the event as clients see them."""
        return self.event.data()


_KEYS: dict[type[Event], tuple[str, ...]] = {}


def _keys(kind: type[Event]) -> tuple[str, ...]:
    """Return the keys of an event's data, looked up once per class."""
    known = _KEYS.get(kind)
    if known is None:
        names = (item.name for item in fields(kind))  # type: ignore[arg-type]
        known = _KEYS[kind] = tuple(name for name in names if name not in kind.hidden)
    return known


def _plain(value: object) -> object:
    if isinstance(value, StateAndMode):
        return value.label
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, tuple):
        return list(value)
    if isinstance(value, Mapping):
        return dict(value)
    return value


def because(words: str, reason: str | None) -> str:
    """Return words with the reason behind them, where there is one."""
    return f"{words}: {reason}" if reason else words
