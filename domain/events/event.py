"""The base class of events, and their entry in the log.

`Outbox.emit` records an event; the core reads its class and fields. Clients see what follows from
the class: `kind`, `data`, a sentence for an operator in `words`, and whether that belongs in a
short list (`notable`).
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import Enum, StrEnum
from typing import ClassVar

from domain.actor import Actor
from domain.state_and_mode import StateAndMode
from domain.timebase import Instant


class Event:
    """A decision, or a fact that became known."""

    __slots__ = ()

    kind: ClassVar[str]
    """Name of the kind for clients, such as `change.succeeded`."""
    is_input: ClassVar[bool] = False
    """An input, from outside or from the clock; recorded once something follows from it."""
    optional: ClassVar[frozenset[str]] = frozenset()
    """Fields that `data` omits while they are None."""
    hidden: ClassVar[frozenset[str]] = frozenset()
    """Fields that `data` always omits."""
    is_notable: ClassVar[bool] = True
    """Whether a short list for operators shows events of this kind."""

    @property
    def words(self) -> str:
        """Return what happened, in one sentence for an operator."""
        return self._words()

    def _words(self) -> str:
        raise NotImplementedError

    @property
    def notable(self) -> bool:
        """Tell whether a short list for operators shows this event."""
        return self.is_notable

    @classmethod
    def data_keys(cls) -> tuple[str, ...]:
        """Return the keys of `data`, in order."""
        return _keys(cls)

    def data(self) -> dict[str, object]:
        """Return the fields as clients see them: labels, texts, numbers, lists and mappings."""
        shown: dict[str, object] = {}
        for name in _keys(type(self)):
            value = getattr(self, name)
            if value is None and name in self.optional:
                continue
            shown[name] = value if type(value) in _ARE_PLAIN else _plain(value)
        return shown


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """An entry of the event log."""

    id: int
    """Rises by one per event."""
    at: Instant
    cause: int | None
    """Id of the event that led to this one; None: it came from outside, or from the clock."""
    actor: Actor
    """Who requested it."""
    event: Event

    @property
    def kind(self) -> str:
        """Return the name of the kind for clients."""
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


_ARE_PLAIN = frozenset({str, int, float, bool, type(None)})
"""Classes of most values, told apart from the others at once."""


def _plain(value: object) -> object:
    if isinstance(value, StrEnum):
        return str(value)
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
    """Return words followed by the reason, if there is one."""
    return f"{words}: {reason}" if reason else words
