"""Readings that have just arrived: the only part of the history that the event loop works on."""

from array import array

import numpy as np

from domain.timebase import Instant
from service.storage.trends.rows import Rows

MOST = 500_000
"""Readings that wait for the thread at most: two minutes of 200 signals at 20 Hz, 11 MB."""


class Intake:
    """Arrays that grow by one reading at a time: appending to them allocates no objects."""

    def __init__(self) -> None:
        self.dropped = 0
        """Readings that found no place, since the thread was kept by a disk."""
        self._clear()

    def add(self, signal: int, at: Instant, value: float, error: int) -> None:
        """Add a reading, or count it as dropped."""
        if len(self._at) >= MOST:
            self.dropped += 1
            return
        self._signal.append(signal)
        self._at.append(at)
        self._value.append(value)
        self._error.append(error)

    def take(self) -> Rows | None:
        """Return the readings since the last call; None: there are none."""
        if not self._at:
            return None
        columns = (self._signal, self._at, self._value, self._error)
        self._clear()
        signal, at, value, error = (np.frombuffer(column, column.typecode) for column in columns)
        return Rows.of_readings(signal.astype(np.int64), at, value, error.astype(np.int64))

    def _clear(self) -> None:
        self._signal, self._at = array("i"), array("q")
        self._value, self._error = array("d"), array("h")
