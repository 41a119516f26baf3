"""Sums of readings without rounding, so that a reading that leaves takes away what it brought.

A float is an integer times a power of two, and integers have any length here: nothing is lost when
1e6 is added and taken away again, and the results do not depend on the order in which readings came
and went. A running sum of floats has to be renewed now and then, which costs as much as the window
is long, and never fits a value near 1e6 whose spread is 1.
"""

import math
from collections.abc import Sequence

from domain.timebase import NANOSECONDS_PER_SECOND, Instant


class ExactSum:
    """Number and sum of the readings of a window."""

    def __init__(self) -> None:
        self.n = 0
        self.shift = 0
        """The sums are in units of 2 ** -shift, the finest that was needed so far."""
        self.sum = 0
        self._scale = 1.0
        """The same as a float: units of 1; infinite if no float is so large."""

    def enter(self, values: Sequence[float]) -> list[int]:
        """Add finite readings; return them in units."""
        numbers = self._in_units(values)
        self.n += len(numbers)
        self.sum += sum(numbers)
        return numbers

    def leave(self, values: Sequence[float]) -> list[int]:
        """Take away readings that had been added; return them in units."""
        numbers = self._in_units(values)
        self.n -= len(numbers)
        self.sum -= sum(numbers)
        return numbers

    def mean(self) -> float:
        """Return the mean of at least one reading, rounded once."""
        return self.sum / (self.n << self.shift)

    def _in_units(self, values: Sequence[float]) -> list[int]:
        scale, numbers = self._scale, []
        for value in values:
            # A power of two rounds nothing, unless the product is infinite.
            number = value * scale
            if not number.is_integer():
                return self._in_finer_units(values)
            numbers.append(int(number))
        return numbers

    def _in_finer_units(self, values: Sequence[float]) -> list[int]:
        """Return readings in units that are made fine enough for all of them."""
        ratios = [value.as_integer_ratio() for value in values]
        shifts = [denominator.bit_length() - 1 for _, denominator in ratios]
        self._refine(max(0, max(shifts) - self.shift))
        units = zip(ratios, shifts, strict=True)
        return [numerator << self.shift - shift for (numerator, _), shift in units]

    def _refine(self, finer: int) -> None:
        """Make the unit smaller by this power of two."""
        self.shift += finer
        self.sum <<= finer
        self._scale = math.ldexp(1.0, self.shift) if self.shift < 1024 else math.inf


class ExactSpread(ExactSum):
    """Number, sum and sum of squares of the readings of a window."""

    def __init__(self) -> None:
        super().__init__()
        self._squares = 0
        """In squared units."""

    def enter(self, values: Sequence[float]) -> list[int]:
        """Add finite readings; return them in units."""
        numbers = super().enter(values)
        for number in numbers:
            self._squares += number * number
        return numbers

    def leave(self, values: Sequence[float]) -> list[int]:
        """Take away readings that had been added; return them in units."""
        numbers = super().leave(values)
        for number in numbers:
            self._squares -= number * number
        return numbers

    @property
    def spread(self) -> int:
        """Return n times the sum of the squared deviations from the mean, in squared units."""
        return self.n * self._squares - self.sum * self.sum

    def deviation(self) -> float:
        """Return the standard deviation of the population of at least one reading."""
        numerator, denominator = self.spread, self.n * self.n << 2 * self.shift
        if not numerator:
            return 0.0
        # The root of a quotient near 1: the square of a large or a small reading is no float.
        half = (numerator.bit_length() - denominator.bit_length()) // 2
        if half > 0:
            denominator <<= 2 * half
        else:
            numerator <<= -2 * half
        return math.ldexp(math.sqrt(numerator / denominator), half)

    def _refine(self, finer: int) -> None:
        super()._refine(finer)
        self._squares <<= 2 * finer


class ExactLine:
    """The line of least squares through the readings of a window."""

    def __init__(self, start: Instant) -> None:
        """Begin empty.

        Args:
            start: The origin of times, so that their squares are short.
        """
        self._start = start
        self._values = ExactSpread()
        self._times = 0
        self._squared_times = 0
        self._products = 0
        """Of times and values; in units of `_products_shift`."""
        self._products_shift = 0

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Add finite readings."""
        self._count(times, self._values.enter(values), 1)

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        """Take away readings that had been added."""
        self._count(times, self._values.leave(values), -1)

    def slope(self) -> float | None:
        """Return the slope per second; None: all readings came at once."""
        width = self._width
        if not width:
            return None
        return self._rise * NANOSECONDS_PER_SECOND / (width << self._values.shift)

    def unexplained(self) -> float:
        """Return the share of the variance that the line leaves, 1 - R2; 1 if nothing varies."""
        whole = self._width * self._values.spread
        return (whole - self._rise * self._rise) / whole if whole else 1.0

    def is_rising(self) -> bool:
        """Tell whether the line rises."""
        return self._rise > 0

    def reaches_at(self, limit: float) -> Instant | None:
        """Return when the line is at a limit, before or after now; None: it is level."""
        if not self._rise:
            return None
        numerator, denominator = limit.as_integer_ratio()
        n = self._values.n
        above_mean = (numerator * n << self._values.shift) - self._values.sum * denominator
        whole = self._times * denominator * self._rise + above_mean * self._width
        return self._start + whole // (n * denominator * self._rise)

    @property
    def _width(self) -> int:
        """Return n times the sum of the squared deviations of the times from their mean."""
        return self._values.n * self._squared_times - self._times * self._times

    @property
    def _rise(self) -> int:
        """Return the slope times `_width`, in units per nanosecond."""
        return self._values.n * self._products - self._times * self._values.sum

    def _count(self, times: Sequence[Instant], numbers: Sequence[int], sign: int) -> None:
        self._products <<= self._values.shift - self._products_shift
        self._products_shift = self._values.shift
        for at, number in zip(times, numbers, strict=True):
            time = at - self._start
            self._times += sign * time
            self._squared_times += sign * time * time
            self._products += sign * time * number
