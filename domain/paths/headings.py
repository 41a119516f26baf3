"""Headings of waypoints: their units, and how well they fit the direction of the path."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from math import hypot, pi, tau

from domain.arrays import Floats, Integers, np

MAX_MISFIT_RAD = pi / 6
"""Headings whose median differs by more from the path are none, or in another unit."""

_CLOSE_RAD = pi / 18
_CHORD_M = 0.5
"""Directions are taken over this chord, or a tenth of the path, since a receiver jitters."""
_FEW_WAYS = 2
_MOST_WAYS = 0.9
_ONE_TURN = 1.001
"""More is not a heading in radians, unless headings are unwrapped over several turns."""
_MOST_TURNS = 100
"""Further unwrapped headings are none: a time in seconds soon has thousands of turns."""


class Heading(StrEnum):
    """Unit, zero direction and sense of headings."""

    RAD = "rad"
    """Radians counter-clockwise from the x axis."""
    DEG = "deg"
    """Degrees counter-clockwise from the x axis."""
    COMPASS = "compass"
    """Degrees clockwise from north, which is the y axis."""
    RAD_NORTH = "rad_north"
    """Radians counter-clockwise from north, as `psi_rad` of race lines."""
    RAD_COMPASS = "rad_compass"
    """Radians clockwise from north, as in NED frames."""

    @property
    def words(self) -> str:
        """Return what it means, for a person."""
        return _WORDS[self]

    def yaws(self, values: Floats) -> Floats:
        """Return headings in rad counter-clockwise from the x axis; shape (n,).

        Radians from the x axis are returned as they are, others wrapped to [-pi, pi).
        """
        match self:
            case Heading.RAD:
                return values
            case Heading.DEG:
                return wrapped(np.radians(values))
            case Heading.COMPASS:
                return wrapped(pi / 2 - np.radians(values))
            case Heading.RAD_NORTH:
                return wrapped(pi / 2 + values)
            case Heading.RAD_COMPASS:
                return wrapped(pi / 2 - values)

    @property
    def turn(self) -> float:
        """Return a full turn in this unit."""
        return 360.0 if self in (Heading.DEG, Heading.COMPASS) else tau


_WORDS = {
    Heading.RAD: "radians counter-clockwise from east",
    Heading.DEG: "degrees counter-clockwise from east",
    Heading.COMPASS: "degrees clockwise from north",
    Heading.RAD_NORTH: "radians counter-clockwise from north",
    Heading.RAD_COMPASS: "radians clockwise from north",
}


@dataclass(frozen=True, slots=True)
class Fit:
    """How headings read in some unit fit the direction of the path."""

    heading: Heading
    misfit_rad: float
    """Median angle between heading and path, 0 to pi / 2; of reversed headings to the way back.

    Of headings that are all the same, 90 % of the angles are smaller.
    """
    is_reversed: bool
    """Whether the headings point against the path, as of a vehicle that drove backwards."""
    follows: bool
    """Whether the headings turn with a path that turns: then these are headings beyond doubt."""
    is_steady: bool
    """Whether neither path nor headings turn, but for noise."""

    @property
    def fits(self) -> bool:
        """Return whether headings, known to be some, are along the path, or against it."""
        return self.misfit_rad <= MAX_MISFIT_RAD

    @property
    def is_close(self) -> bool:
        """Return whether the headings are those of the path, but for noise."""
        return self.misfit_rad <= _CLOSE_RAD

    @property
    def is_convincing(self) -> bool:
        """Return whether numbers that may be anything are headings.

        A speed or a width is within 30 degrees of half of any path, in one of several units.
        """
        return self.fits and (self.is_close or self.follows or self.is_steady)


class Ways:
    """Directions of the path between waypoints."""

    def __init__(self, places: Floats) -> None:
        """Find the directions.

        Args:
            places: Positions of the waypoints, shape (n, 2), n >= 1: x m, y m; finite.
        """
        kept = _apart(places)
        steps = np.diff(places[kept], axis=0)
        # A heading may be that of the way to a waypoint, or from it.
        self._beside = (kept[:-1], (kept[:-1] + kept[1:]) // 2, kept[1:])
        self._angles = np.arctan2(steps[:, 1], steps[:, 0])

    @property
    def count(self) -> int:
        """Return the number of directions; 0 if all positions are the same."""
        return len(self._angles)

    def fit(self, values: Floats, heading: Heading) -> Fit:
        """Return how headings fit the path.

        Where there is no more than one direction, any heading within a turn fits: two waypoints
        say too little to doubt their headings.

        Args:
            values: Headings of all waypoints, shape (n,); finite.
            heading: Their unit.
        """
        most = _MOST_TURNS if self.count >= _FEW_WAYS else _ONE_TURN
        if float(np.abs(values).max()) > most * heading.turn:
            return Fit(heading, pi / 2, is_reversed=False, follows=False, is_steady=False)
        if self.count < _FEW_WAYS:
            return Fit(heading, 0.0, is_reversed=False, follows=False, is_steady=True)
        # What never changes is no heading of a path that turns now and then.
        share = _MOST_WAYS if float(np.ptp(values)) == 0.0 else 0.5
        yaws = heading.yaws(values)
        signed = [wrapped(yaws[at] - self._angles) for at in self._beside]
        ahead = [float(np.quantile(np.abs(errors), share)) for errors in signed]
        back = min(float(np.quantile(pi - np.abs(errors), share)) for errors in signed)
        rest = _spread(signed[int(np.argmin(ahead))])
        turning = _spread(self._angles)
        return Fit(
            heading,
            min(*ahead, back, pi / 2),
            is_reversed=back < min(ahead),
            follows=turning > _CLOSE_RAD and rest <= turning / 2,
            is_steady=turning <= _CLOSE_RAD and rest <= _CLOSE_RAD,
        )

    def best_fit(
        self, values: Floats, among: Iterable[Heading], *, is_named: bool = True
    ) -> tuple[Fit, bool]:
        """Return the fit of the unit that these headings probably have, and whether they have it.

        Radians within a turn that fit are radians. Otherwise headings along the path are preferred
        to reversed ones, and earlier units to later ones.

        Args:
            values: As for `fit`.
            among: Possible units, at least one.
            is_named: Whether these are known to be headings; otherwise the fit has to show it.
        """
        fits = [self.fit(values, heading) for heading in among]
        taken = [fit.fits if is_named else fit.is_convincing for fit in fits]
        is_within_a_turn = float(np.abs(values).max()) <= _ONE_TURN * tau
        if fits[0].heading is Heading.RAD and taken[0] and is_within_a_turn:
            return fits[0], True
        fit, is_taken = min(
            zip(fits, taken, strict=True),
            key=lambda found: (not found[1], found[0].is_reversed, found[0].misfit_rad),
        )
        return fit, is_taken

    def first_misfit(self, values: Floats, heading: Heading) -> int:
        """Return the index of the first waypoint whose heading differs too much from the path."""
        at = self._beside[1]
        errors = np.abs(wrapped(heading.yaws(values)[at] - self._angles))
        beyond = np.minimum(errors, pi - errors) > MAX_MISFIT_RAD
        return int(at[int(beyond.argmax())]) if beyond.any() else 0


def along(places: Floats) -> Floats:
    """Return the directions of a path at its waypoints, rad; shape (n,).

    At a waypoint it is the direction from the one before to the next one. Where these are at the
    same position it is that of the waypoint before; 0 if there is none.

    Args:
        places: Positions of the waypoints, shape (n, 2), n >= 2: x m, y m; finite.
    """
    steps = places[np.minimum(np.arange(len(places)) + 1, len(places) - 1)]
    steps = steps - places[np.maximum(np.arange(len(places)) - 1, 0)]
    moved = np.hypot(steps[:, 0], steps[:, 1]) > 0
    if not moved.any():
        return np.zeros(len(places))
    last = np.maximum.accumulate(np.where(moved, np.arange(len(places)), int(moved.argmax())))
    return np.asarray(np.arctan2(steps[last, 1], steps[last, 0]))


def wrapped(angles: Floats) -> Floats:
    """Return angles wrapped to [-pi, pi), rad; same shape."""
    return np.asarray((angles + pi) % (2 * pi) - pi)


def _spread(angles: Floats) -> float:
    """Return the median difference of angles from their mean, rad."""
    mean = np.arctan2(np.sin(angles).mean(), np.cos(angles).mean())
    return float(np.median(np.abs(wrapped(angles - mean))))


def _apart(places: Floats) -> Integers:
    """Return the indices of waypoints at least a chord apart, from the first one; shape (k,)."""
    extent = float(np.hypot(*(places - places[0]).T).max())
    chord = min(_CHORD_M, extent / 10)
    kept = [0]
    if chord > 0:
        xs, ys = places[:, 0].tolist(), places[:, 1].tolist()
        x, y = xs[0], ys[0]
        for index in range(1, len(xs)):
            if hypot(xs[index] - x, ys[index] - y) >= chord:
                kept.append(index)
                x, y = xs[index], ys[index]
    return np.array(kept, dtype=np.int64)
