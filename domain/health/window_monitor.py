"""A monitor: a signal whose value is computed from the readings of another one over a window."""

from collections.abc import Iterator

from domain.findings import Blocker
from domain.health.feed import Feed
from domain.health.good_range import GoodRange
from domain.health.held_readings import HeldReading
from domain.health.signal_monitor import SignalMonitor
from domain.health.signal_reasons import unknown_reason
from domain.health.signals import Bound, Comparison, ModeLimit, MonitorSettings, SignalSettings
from domain.inputs import SignalValue
from domain.snapshot import MonitorView
from domain.timebase import Instant, seconds
from domain.windows.crossings import earliest
from domain.windows.settings import OF_ARRIVALS, Statistic, Threshold

SOURCE = "monitor"
"""Source of the values of all monitors."""

SHOWN_EVERY = seconds(0.5)
"""How often a value that time alone changes is computed only to be shown."""

COMPUTED_EVERY = seconds(0.05)
"""How often readings lead to a new value at most, unless one of them is beyond a bound itself: a
signal may be read a thousand times a second."""

LATEST = seconds(0.1)
"""Time after a value was computed until a reading since then is taken account of at the latest, and
one that left the window at the earliest: a signal that is read more often wakes nobody."""

_MOVED_BY_EACH = frozenset(
    {
        Statistic.MEAN,
        Statistic.STD,
        Statistic.SLOPE,
        Statistic.PERCENTILE,
        Statistic.TIME_TO_LIMIT,
    }
)
"""Statistics that any reading may take across a bound when it leaves the window."""

_AMONG_READINGS = frozenset({Statistic.MEAN, Statistic.MIN, Statistic.MAX, Statistic.PERCENTILE})
"""Statistics that only a reading beyond a bound takes across it."""


class WindowMonitor(SignalMonitor):
    """One monitor: the statistic is its reading, and an error follows from it as from any other.

    It is computed when readings of its signal come, and when time alone may take the value across a
    bound. While it is unknown no error is raised and nothing counts; an error that is on stays as
    long as readings are missing.
    """

    def __init__(
        self, settings: SignalSettings, monitor: MonitorSettings, feed: Feed, start: Instant
    ) -> None:
        """Begin to listen.

        Args:
            settings: The signal that it is.
            monitor: What it computes.
            feed: The readings that it has.
            start: The current time.
        """
        self.of = monitor.of
        self.window = feed.windows.window(monitor.window)
        self._feed = feed
        self._statistic = monitor.window.statistic
        self._changes_with_time = (
            monitor.window.length is not None
            or self._statistic is Statistic.TIME_TO_LIMIT
            or self._statistic in OF_ARRIVALS
            or self._statistic is Statistic.STUCK_FOR
        )
        self._was_fed = False
        self._computed_at = start - COMPUTED_EVERY
        """When readings were taken account of last."""
        self._value_known: SignalValue | None = None
        """The last value that was known."""
        self.owed_at: Instant | None = None
        """When the next reading has to be taken account of; None: all are."""
        self.owed_until: Instant | None = None
        """When a reading has to be taken account of even without another one; None: all are."""
        self.harmless = GoodRange()
        """The readings that take its value across no bound at once."""
        self.is_put_off = False
        """When it was judged last, its deadline became no earlier."""
        self._readings_put_off = False
        """Whether no good reading lets time take the value across a bound earlier."""
        self._crosses_at: Instant | None = None
        """When time alone may take the value across a bound; None: it cannot."""
        self._shown_at: Instant | None = None
        """When the value has to be computed to be shown; None: time does not change it."""
        super().__init__(settings, start)
        self._note_bounds()
        feed.join(self)
        self.judge(start)

    def feed(self, value: float, now: Instant) -> bool:
        """Note a reading; tell whether `judge` has to follow after those beside it."""
        self._was_fed = True
        lowest, highest = self.harmless
        if self._cause is None and not lowest <= value <= highest:
            self.owed_at, self.owed_until = now, self._computed_at + LATEST
        elif self.owed_at is None:
            self.owed_at = max(now, self._computed_at + COMPUTED_EVERY)
            self.owed_until = self._computed_at + LATEST
        return self.owed_at <= now

    def judge(self, now: Instant) -> None:
        """Compute the value as of `now`, and what follows from it."""
        value = self.window.value(now)
        is_same = False
        if value is None:
            self._look()
            self._lose_value()
            # Without readings an error is not known to be over. With readings that have no value it
            # is: no trend leads to the limit any more.
            cause = None if self.window.has_enough(now) else self._cause
            self._judge([] if cause is None else [cause], now)
        elif self.is_calm and self._is_good(value):
            is_same = self._was_fed and self.readings.newest is not None
            if self._hold(value, now):
                self._note_change(None)
        else:
            self._hold(value, now)
            self._judge(self._count(now), now)
        self._plan(now, is_same=is_same)
        if self._was_fed:
            self._computed_at = now
        self.owed_at = self.owed_until = None
        self._was_fed = False
        self._feed.note_judged()

    def set_limit(self, limit: ModeLimit | None, now: Instant) -> None:
        """Put another limit in force, and judge the value anew; see `SignalMonitor`."""
        value = self.window.value(now)
        self._look()
        if value is None:
            self._lose_value()
        else:
            self._hold(value, now)
        super().set_limit(limit, now)
        self._note_bounds()
        self._feed.note_harmless()

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never.

        When readings are owed, `owed_until` tells.
        """
        at = earliest(self._crosses_at, self._shown_at)
        return at if self.is_calm else earliest(at, super().wake_at())

    def reasons(self) -> Iterator[Blocker]:
        """Yield why the errors are active, one reason per cause."""
        if self._cause is None or self.readings.newest is not None or self._value_known is None:
            yield from super().reasons()
        else:
            message = unknown_reason(self.settings, self._cause, self._value_known)
            yield self._reason(self._value_slot, message, threshold=self._cause.threshold)

    def monitor_view(self, now: Instant) -> MonitorView:
        """Return what is computed."""
        window, limits = self.window.settings, dict[str, float]()
        for bound in self.settings.bounds:
            limits[str(bound.comparison)] = float(bound.threshold)
            if bound.clear_threshold is not None:
                limits["clear_threshold"] = bound.clear_threshold
        value = self.readings.value
        return MonitorView(
            self.settings.spec.name,
            self.of,
            str(window.statistic),
            window.length,
            window.size,
            self.window.filled(now),
            None if value is None else float(value),
            limits,
            None if self.limit is None else self.limit.name,
        )

    # --- inside ----------------------------------------------------------------------------------

    def _hold(self, value: float, now: Instant) -> bool:
        """Hold the value, and tell whether that changed anything.

        It is as old as the last reading, or as what time made of it.
        """
        newest = self.readings.newest
        if newest is not None and not self._was_fed and value == newest.value:
            return False
        since = now if newest is None or newest.value != value else newest.since
        self.readings.newest = HeldReading(value, SOURCE, now, None, None, since)
        self._value_known = value
        return True

    def _note_bounds(self) -> None:
        """Note what follows from the bounds alone."""
        self.harmless = self._good if self._statistic in _AMONG_READINGS else GoodRange()
        self._readings_put_off = self._is_put_off_by_readings()

    def _lose_value(self) -> None:
        self.readings.newest = None
        self._counting_since = None

    def _plan(self, now: Instant, *, is_same: bool) -> None:
        """Note when the value has to be computed again without a reading.

        Args:
            now: The current time.
            is_same: The value was known and good before, and readings left it so. They put off
                when time alone takes it across a bound, or leave that as it is.
        """
        crosses_at, shown_at = self._crosses_at, self._shown_at
        self.is_put_off = False
        if is_same and self._readings_put_off:
            self._shown_at = now + SHOWN_EVERY if self._changes_with_time else None
            if crosses_at is None or crosses_at > now:
                self.is_put_off = shown_at is not None and shown_at <= now + SHOWN_EVERY
                if crosses_at is not None and self._statistic in _MOVED_BY_EACH:
                    self._crosses_at = max(crosses_at, now + LATEST)
                return
        changes_at = self.window.changes_at(now)
        self._shown_at = None if changes_at is None else max(changes_at, now + SHOWN_EVERY)
        crossings = (self._crossing(bound, now) for bound in self.settings.bounds)
        self._crosses_at = None if changes_at is None else earliest(*crossings)

    def _is_put_off_by_readings(self) -> bool:
        """Tell whether no good reading lets time take the value across a bound earlier."""
        if self._statistic is Statistic.GAP:
            # A silence that is over can leave the window.
            below = (bound.comparison is Comparison.BELOW for bound in self.settings.bounds)
            return not any(below)
        return self._statistic is not Statistic.TIME_TO_LIMIT

    def _crossing(self, bound: Bound, now: Instant) -> Instant | None:
        limit = bound.clear_limit if bound is self._cause else float(bound.threshold)
        threshold = Threshold(limit, above=bound.comparison is Comparison.ABOVE)
        at = self.window.crosses_at(threshold, now)
        return max(at, now + LATEST) if at and self._statistic in _MOVED_BY_EACH else at
