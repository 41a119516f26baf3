"""Leaves out points of a line that are not needed to draw it.

Source: D. Douglas and T. Peucker, "Algorithms for the reduction of the number of points required to
represent a digitized line", 1973; all pieces of a stretch are split at once.
"""

from itertools import pairwise

from domain.arrays import Floats, Integers, np

STRETCH = 2_000
"""Points that are looked at in one go: some 2 ms. Where one stretch ends and the next one begins, a
point is kept in any case."""


class Decimation:
    """The points of a line that keep every other one within a tolerance, found bit by bit.

    A line that needs more of them than are allowed is split where it is farthest off, so that it is
    drawn as well as it can be; each stretch has its share of them.
    """

    def __init__(self, places: Floats, tolerance_m: float, most: int) -> None:
        """Prepare.

        Args:
            places: Shape (n, 2): x m, y m; n >= 2.
            tolerance_m: How far a point that is left out may be from the drawn line, m.
            most: Points that may be kept; at least two for each stretch.
        """
        self._x, self._y = np.ascontiguousarray(places[:, 0]), np.ascontiguousarray(places[:, 1])
        self._tolerance_m2 = tolerance_m**2
        last = len(places) - 1
        count = -(-last // STRETCH)
        self._ends = [*range(0, last, STRETCH), last]
        self._stretches = list(pairwise(self._ends))
        self._share = (most - count - 1) / count
        """Points that each stretch may add to the ends; what one leaves is for those after it."""
        self._done = 0
        self._inner: list[Integers] = []
        self._spent = 0

    @property
    def is_done(self) -> bool:
        """Tell whether all points are found."""
        return self._done == len(self._stretches)

    @property
    def indices(self) -> Integers:
        """Return the indices of the points that are kept so far, in order."""
        return np.sort(np.concatenate((np.array(self._ends), *self._inner)))

    def go_on(self) -> None:
        """Look at the next stretch; there must be one."""
        first, last = self._stretches[self._done]
        self._done += 1
        inner = self._split(first, last, int(self._done * self._share) - self._spent)
        self._spent += len(inner)
        self._inner.append(inner)

    def _split(self, first: int, last: int, room: int) -> Integers:
        """Return the points of a stretch that are kept besides its ends."""
        firsts, lasts = np.array([first]), np.array([last])
        kept = [np.empty(0, dtype=np.int64)]
        while len(firsts) and room > 0:
            off_m2, at = self._farthest(firsts, lasts)
            by_need = np.argsort(-off_m2, kind="stable")
            worst = by_need[: min(room, np.count_nonzero(off_m2 > self._tolerance_m2))]
            room -= len(worst)
            kept.append(at[worst])
            begins = np.concatenate((firsts[worst], at[worst]))
            ends = np.concatenate((at[worst], lasts[worst]))
            is_open = ends - begins > 1
            firsts, lasts = begins[is_open], ends[is_open]
        return np.concatenate(kept)

    def _farthest(self, firsts: Integers, lasts: Integers) -> tuple[Floats, Integers]:
        """Return how far the farthest point of each piece is from its chord, m2, and its index."""
        counts = lasts - firsts
        begins = np.cumsum(counts) - counts
        index = np.arange(int(np.sum(counts))) + np.repeat(firsts - begins, counts)
        chord_x, chord_y = self._x[lasts] - self._x[firsts], self._y[lasts] - self._y[firsts]
        length_m2 = np.maximum(chord_x**2 + chord_y**2, np.finfo(float).tiny)
        x = self._x[index] - np.repeat(self._x[firsts], counts)
        y = self._y[index] - np.repeat(self._y[firsts], counts)
        chord_x, chord_y = np.repeat(chord_x, counts), np.repeat(chord_y, counts)
        along = np.clip((x * chord_x + y * chord_y) / np.repeat(length_m2, counts), 0.0, 1.0)
        off_m2 = (x - along * chord_x) ** 2 + (y - along * chord_y) ** 2
        most_m2 = np.maximum.reduceat(off_m2, begins)
        is_most = np.flatnonzero(off_m2 == np.repeat(most_m2, counts))
        at = is_most[np.searchsorted(is_most, begins)]
        return most_m2, index[at]
