"""Watches that a vehicle stays near a line and makes progress along it."""

from dataclasses import dataclass
from math import inf

from domain.timebase import Duration, Instant, to_seconds


class GivenUpError(Exception):
    """The goal is aborted; the message says why."""


@dataclass(frozen=True, slots=True)
class LegLimits:
    """When a line is given up."""

    max_cross_track_m: float
    """Cross-track error, m, that is too large if it lasts."""
    max_cross_track_for: Duration
    no_progress_for: Duration
    """This long without `least_progress_m` of progress."""
    least_progress_m: float


class LineWatch:
    """How far a vehicle came along a line, and for how long it has been away from it."""

    def __init__(self, name: str, now: Instant) -> None:
        """Begin.

        Args:
            name: Of the line, for a person: "the path".
            now: The current time.
        """
        self._name = name
        self._best_m = -inf
        """Largest distance along the line that counted as progress."""
        self._best_at = now
        self._off_since: Instant | None = None

    def judge(self, error_m: float, distance_m: float, limits: LegLimits, now: Instant) -> None:
        """Give up a line that the vehicle does not follow.

        Args:
            error_m: Cross-track error, m.
            distance_m: Distance of the vehicle along the line, m.
            limits: When the line is given up.
            now: The current time.

        Raises:
            GivenUpError: A limit was reached.
        """
        error_m = abs(error_m)
        if error_m <= limits.max_cross_track_m:
            self._off_since = None
        elif self._off_since is None:
            self._off_since = now
        elif now - self._off_since >= limits.max_cross_track_for:
            long_s = to_seconds(limits.max_cross_track_for)
            raise GivenUpError(f"{error_m:.1f} m from {self._name} for {long_s:g} s")
        if distance_m >= self._best_m + limits.least_progress_m:
            self._best_m, self._best_at = distance_m, now
        elif now - self._best_at >= limits.no_progress_for:
            raise GivenUpError(f"no progress for {to_seconds(limits.no_progress_for):g} s")
