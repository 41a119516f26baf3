"""Rates from counters that only grow."""

import time
from collections.abc import Callable


class Rate:
    """How fast a counter grows, from one look to the next."""

    def __init__(self, read_s: Callable[[], float] = time.monotonic) -> None:
        self._read_s = read_s
        self._last: tuple[float, float] | None = None

    def per_second(self, counter: float) -> float | None:
        """Return the rate since the last look; None: this is the first, or it began anew."""
        now, last = self._read_s(), self._last
        self._last = (now, counter)
        if last is None or counter < last[1] or now <= last[0]:
            return None
        return (counter - last[1]) / (now - last[0])
