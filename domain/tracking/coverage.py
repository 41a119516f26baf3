"""Which part of a path a vehicle came near: the rest was left out."""

from math import ceil, hypot
from typing import TypeAlias

from domain.arrays import np
from domain.paths.path import Path
from domain.timebase import to_seconds
from domain.vehicle import COMMAND_VALID_FOR, VehicleState

STEP_M = 0.25
"""The path is judged in pieces of this length."""
MAX_TRAIL = 4_000
"""Bound on remembered positions; a longer trail is thinned."""


_Place: TypeAlias = tuple[float, float]


class Coverage:
    """Sorts the path behind a vehicle into what it passed and what it left out.

    A vehicle that cannot steer a hairpin is projected onto the path behind it: it left the hairpin
    out. One that turns beside the path before it gets onto it does not: its trail counts.
    """

    def __init__(
        self,
        path: Path,
        reached_m: float,
        left_out_m: float,
        near_m: float,
        braking_mps2: float,
    ) -> None:
        """Go on from what is known.

        Args:
            path: The path.
            reached_m: Distance along the path up to which it is judged, m.
            left_out_m: Length that was left out up to there, m.
            near_m: What the vehicle came no nearer than this is left out, m.
            braking_mps2: How hard the vehicle brakes while nobody hears of it.
        """
        self.path = path
        self.reached_m = reached_m
        self.left_out_m = left_out_m
        self._near_m = near_m
        self._braking_mps2 = braking_mps2
        self._step_m = min(STEP_M, near_m / 4)
        self._last: VehicleState | None = None
        self._unseen_s = 0.0
        self._trail: list[_Place] = []
        """Where the vehicle was since the path was judged last."""

    def go_on_from(self, last: VehicleState, unseen_s: float) -> None:
        """Go on from where a vehicle was seen last.

        Args:
            last: Of the vehicle, with the highest speed that it had thereafter.
            unseen_s: So long it was driven on at most, s.
        """
        self._last, self._unseen_s = last, unseen_s

    def may_have_rolled(self, state: VehicleState) -> bool:
        """Tell whether the vehicle may have come here by itself since it was noted last.

        Without commands it brakes: so it stops when its reports, or the supervision, pause.
        """
        last = self._last
        if last is None:
            return False
        speed = abs(last.speed_mps)
        unheard_s = self._unseen_s + to_seconds(COMMAND_VALID_FOR)
        most_m = speed * unheard_s + speed * speed / (2 * self._braking_mps2)
        return _apart(_place(last), _place(state)) <= most_m

    def least_missed_m(self, state: VehicleState) -> float:
        """Return a lower bound of what a vehicle left out that is found further along the path, m.

        No path is shorter than the straight line from where the vehicle was known to be. Judging
        the pieces of a path up to a pose that jumped by kilometres would take seconds.

        Args:
            state: Of the vehicle, before it is noted.
        """
        if self.may_have_rolled(state):
            return 0.0
        begin, here = self.path.point_at(self.reached_m), _place(state)
        known = [(begin.x_m, begin.y_m), *self._trail]
        if self._last is not None:
            known.append(_place(self._last))
        return min(_apart(place, here) for place in known) - 2 * self._near_m

    def note(self, state: VehicleState, distance_m: float | None) -> None:
        """Judge the path up to where the vehicle is.

        Args:
            state: Of the vehicle.
            distance_m: Its distance along the path, m; None: it is not driving along it.
        """
        here = _place(state)
        if self._last is not None and self.may_have_rolled(state):
            self._trail += _between(_place(self._last), here, self._step_m)
        self._last, self._unseen_s = state, 0.0
        moved = not self._trail or _apart(self._trail[-1], here) >= self._step_m
        is_ahead = distance_m is not None and distance_m > self.reached_m
        if moved or is_ahead:
            self._trail.append(here)
        if distance_m is not None and is_ahead:
            self.left_out_m += self.missed_m(distance_m)
            self.reached_m = distance_m
            self._trail.clear()
        elif len(self._trail) > MAX_TRAIL:
            del self._trail[::2]

    def missed_m(self, distance_m: float) -> float:
        """Return what was not passed of the path up to a distance along it, m."""
        if not self._trail or distance_m <= self.reached_m:
            return 0.0
        trail = np.array(self._trail)
        x_m, y_m = self._trail[-1]
        missed_m, begin_m = 0.0, self.reached_m
        while begin_m < distance_m:
            end_m = min(begin_m + self._step_m, distance_m)
            middle = self.path.point_at((begin_m + end_m) / 2)
            away_m = hypot(middle.x_m - x_m, middle.y_m - y_m)
            if away_m > self._near_m:
                away_m = float(np.hypot(*(trail - (middle.x_m, middle.y_m)).T).min())
            if away_m > self._near_m:
                missed_m += end_m - begin_m
            begin_m = end_m
        return missed_m


def _place(state: VehicleState) -> _Place:
    return state.pose.x_m, state.pose.y_m


def _apart(one: _Place, other: _Place) -> float:
    return hypot(one[0] - other[0], one[1] - other[1])


def _between(one: _Place, other: _Place, spacing_m: float) -> list[_Place]:
    """Return places on the straight line between two, both left out."""
    count = ceil(_apart(one, other) / spacing_m)
    dx, dy = (other[0] - one[0]) / max(count, 1), (other[1] - one[1]) / max(count, 1)
    return [(one[0] + n * dx, one[1] + n * dy) for n in range(1, count)]
