"""Readings that have just arrived: the only part of the history that the event loop works on."""

from array import array
from collections import defaultdict

from domain.timebase import Instant
from service.storage.trends.rows import RANKS, TIMES, VALUES, Rows, RowsBySignal

MOST = 500_000
"""Readings that wait for the thread at most: two minutes of 200 signals at 20 Hz, 11 MB."""


class _Readings:
    """Of one signal: arrays that grow by one reading at a time, which allocates no objects."""

    def __init__(self) -> None:
        self.at, self.value, self.error = array(TIMES), array(VALUES), array(RANKS)
        self.appends = self.at.append, self.value.append, self.error.append
        """Of each array; to look them up takes a third of the time of a reading."""


class Intake:
    """Readings by signal until the thread takes them."""

    def __init__(self) -> None:
        self.dropped = 0
        """Readings that found no place, since the thread was kept by a disk."""
        self._by_signal = defaultdict[int, _Readings](_Readings)
        self._room = MOST

    def add(self, signal: int, at: Instant, value: float, error: int) -> None:
        """Add a reading, or count it as dropped."""
        if not self._room:
            self.dropped += 1
            return
        self._room -= 1
        add_at, add_value, add_error = self._by_signal[signal].appends
        add_at(at)
        add_value(value)
        add_error(error)

    def take(self) -> RowsBySignal:
        """Return the readings since the last call."""
        taken = self._by_signal
        self._by_signal, self._room = defaultdict(_Readings), MOST
        return {
            signal: Rows.of_readings(readings.at, readings.value, readings.error)
            for signal, readings in taken.items()
        }
