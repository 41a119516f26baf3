"""What a device may tell of, and ages instead of times in what it tells."""

from dataclasses import replace

from domain.inputs import ErrorReport, ReactionReport, Readings, SourceFault
from domain.link.messages import Told
from domain.link.settings import Owned
from domain.timebase import Instant


class Ownership:
    """Lets pass what concerns the parts and signals of one device."""

    def __init__(self, owned: Owned) -> None:
        """Prepare.

        Args:
            owned: By the device.
        """
        self.nodes = frozenset(owned.nodes)
        self._parts = self.nodes | set(owned.systems)
        self._signals = frozenset(owned.signals)

    def admit(self, told: Told) -> Told | None:
        """Return what of it concerns the device; None: nothing does."""
        match told:
            case Readings():
                own = tuple(item for item in told.items if item.signal in self._signals)
                if len(own) == len(told.items):
                    return told
                return replace(told, items=own) if own else None
            case SourceFault():
                return told if told.signal in self._signals else None
            case ErrorReport() | ReactionReport():
                return told if told.part in self._parts else None
            case _:
                return told if told.node in self.nodes else None


def with_ages(told: Told, now: Instant) -> Told:
    """Return what is told with stamps relative to `now`, for another computer."""
    return _shifted(told, -now)


def with_stamps(told: Told, now: Instant) -> Told:
    """Return what another computer told with stamps of our clock; it was sent just now."""
    return _shifted(told, now)


def _shifted(told: Told, by: int) -> Told:
    if not isinstance(told, Readings) or all(item.stamp is None for item in told.items):
        return told
    items = tuple(
        item if item.stamp is None else replace(item, stamp=item.stamp + by) for item in told.items
    )
    return replace(told, items=items)
