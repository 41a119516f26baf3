"""Which changes of a signal's view are readings that count in its history."""

from collections.abc import Callable, Iterable
from typing import TypeAlias

from domain.inputs import SignalValue
from domain.snapshot import SignalView
from domain.timebase import Instant
from service.storage.trends.trends import Trends

_Reading: TypeAlias = tuple[Instant, SignalValue | None, Instant | None]


class Sampling:
    """Looks at signals whose view changed, and notes their readings."""

    def __init__(self, trends: Trends, signal: Callable[[str], SignalView]) -> None:
        """Prepare.

        Args:
            trends: Takes the readings.
            signal: Returns the view of a signal.
        """
        self._trends = trends
        self._signal = signal
        self._readings: dict[str, _Reading] = {}
        self._errors: dict[str, str | None] = {}

    def note(self, changed: Iterable[str], at: Instant) -> None:
        """Note the readings that led to changed views.

        An error that time alone raises between two readings counts with the value that is held,
        so that it is in the history even if the next reading clears it.

        Args:
            changed: Signals whose view changed in one step of the core.
            at: Time of the step.
        """
        for name in changed:
            view = self._signal(name)
            value, received_at = view.value, view.received_at
            if value is None or received_at is None:
                continue
            reading, error = (received_at, value, view.stamp), view.error
            if reading != self._readings.get(name):
                self._readings[name] = reading
                self._trends.note(name, received_at, value, error)
            elif error is not None and error != self._errors.get(name) and not view.stale:
                self._trends.note(name, at, value, error)
            self._errors[name] = error
