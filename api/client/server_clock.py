"""The service's clock as seen from here."""

from math import inf, isfinite

_WINDOW_S = 10.0


class ServerClock:
    """Estimates the offset between our clock and the service's from the times in its frames.

    A frame is late by its travel, never early, so the smallest offset of the last 10 to 20 s is the
    nearest to the truth. Older ones are forgotten, since either clock may be set.
    """

    def __init__(self) -> None:
        self._window_start_s = -inf
        self._smallest_s = inf
        self._smallest_before_s = inf

    def observe(self, server_s: float, local_s: float) -> None:
        """Take the time of a frame.

        Args:
            server_s: What the frame says, in seconds since 1970.
            local_s: When it came, in seconds since 1970.
        """
        if local_s - self._window_start_s > _WINDOW_S:
            self._smallest_before_s, self._smallest_s = self._smallest_s, inf
            self._window_start_s = local_s
        self._smallest_s = min(self._smallest_s, local_s - server_s)

    def at(self, local_s: float) -> float:
        """Return the service's time, in seconds since 1970; before the first frame our own."""
        offset_s = min(self._smallest_s, self._smallest_before_s)
        return local_s - offset_s if isfinite(offset_s) else local_s
