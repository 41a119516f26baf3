"""The readings of a stretch of time, with all statistics of them."""

from collections.abc import Callable
from typing import TypeAlias

from domain.timebase import Duration, Instant
from domain.windows.contents import Contents
from domain.windows.measure import Measure
from domain.windows.settings import Statistic, Threshold

_MOST_NEW = 256
"""Readings that wait to be taken over at most."""

_What: TypeAlias = tuple[Statistic, float | None, Threshold | None, float]
"""All that tells statistics of the same readings apart."""


class Span:
    """The readings of a window, and what several statistics make of them.

    A reading is only noted; it is taken over when somebody asks. Several at once cost far less than
    one by one, and a signal is read more often than anybody asks.
    """

    def __init__(self, length: Duration | None, size: int, start: Instant) -> None:
        """Begin empty; the arguments are those of `Contents`."""
        self.contents = Contents(length, size, start)
        """Up to date after `catch_up` only."""
        self._measures: dict[_What, Measure] = {}
        self._new_times: list[Instant] = []
        self._new_values: list[float] = []
        """Readings that are not taken over yet."""

    def measure(self, what: _What, make: Callable[[], Measure]) -> Measure:
        """Return a statistic of the readings, the same for all that want it.

        Args:
            what: Tells it from others.
            make: Makes it; there are no readings yet.
        """
        if what not in self._measures:
            self._measures[what] = make()
        return self._measures[what]

    def add(self, at: Instant, value: float) -> None:
        """Take in a reading, which is finite and not older than those before."""
        self._new_times.append(at)
        self._new_values.append(value)
        if len(self._new_times) >= _MOST_NEW:
            self.take_over()

    def catch_up(self, now: Instant) -> None:
        """Take over the new readings, and leave out those that are too old."""
        if self._new_times:
            self.take_over()
        if self.contents.next_leaves_at <= now:
            self._leave(*self.contents.pop_until(now))

    def take_over(self) -> None:
        """Take over the new readings, and leave out what was too old when they came."""
        times, values = self._new_times, self._new_values
        if not times:
            return
        self._new_times, self._new_values = [], []
        if self.contents.is_exceeded_by(len(times)):
            self._take_one_by_one(times, values)
        else:
            self._take(times, values)
        if self.contents.next_leaves_at <= times[-1]:
            self._leave(*self.contents.pop_until(times[-1]))

    def _take(self, times: list[Instant], values: list[float]) -> None:
        """Take over new readings before those leave that they replace."""
        self.contents.extend(times, values)
        for measure in self._measures.values():
            measure.enter(times, values)
        if (surplus := self.contents.surplus) > 0:
            self._leave(*self.contents.pop_first(surplus))

    def _take_one_by_one(self, times: list[Instant], values: list[float]) -> None:
        """Take over new readings of which some may have to go before their time."""
        contents = self.contents
        for at, value in zip(times, values, strict=True):
            if contents.next_leaves_at <= at:
                self._leave(*contents.pop_until(at))
            if contents.is_full:
                self._leave(*contents.make_room())
            self._take([at], [value])

    def _leave(self, times: list[Instant], values: list[float]) -> None:
        for measure in self._measures.values():
            measure.leave(times, values)
