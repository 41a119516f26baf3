"""A monitor: a signal whose value is computed from the readings of another one over a window."""

from collections.abc import Iterator

from domain.findings import Blocker
from domain.health.held_readings import HeldReading
from domain.health.signal_monitor import SignalMonitor
from domain.health.signal_reasons import unknown_reason
from domain.health.signals import Bound, Comparison, MonitorSettings, SignalSettings
from domain.inputs import SignalValue
from domain.snapshot import MonitorView
from domain.timebase import Instant, seconds
from domain.windows.crossings import earliest
from domain.windows.settings import Statistic, Threshold
from domain.windows.window import Window

SOURCE = "monitor"
"""Source of the values of all monitors."""

SHOWN_EVERY = seconds(0.5)
"""How often a value that time alone changes is computed only to be shown."""

LEAVING_EVERY = seconds(0.05)
"""How often a value is computed at most because readings leave the window. A reading computes it
anew anyway, and most signals are read more often."""

_OF_ALL_VALUES = frozenset(
    {
        Statistic.MEAN,
        Statistic.STD,
        Statistic.SLOPE,
        Statistic.PERCENTILE,
        Statistic.TIME_TO_LIMIT,
    }
)
"""Statistics that any reading may take across a bound when it leaves the window."""


class WindowMonitor(SignalMonitor):
    """One monitor: the statistic is its reading, and an error follows from it as from any other.

    It is computed when readings of its signal come, and when time alone may take the value across a
    bound. While it is unknown no error is raised and nothing counts; an error that is on stays as
    long as readings are missing.
    """

    def __init__(self, settings: SignalSettings, monitor: MonitorSettings, start: Instant) -> None:
        self.of = monitor.of
        self.window = Window(monitor.window, start)
        self._patience = LEAVING_EVERY if monitor.window.statistic in _OF_ALL_VALUES else 0
        self._was_fed = False
        self._value_known: SignalValue | None = None
        """The last value that was known."""
        self._look_at: Instant | None = None
        """When the value has to be computed again without a reading."""
        super().__init__(settings, start)
        self.judge(start)

    def feed(self, value: float, now: Instant) -> None:
        """Take in a reading; `judge` computes what follows from it, once for all of one message."""
        self.window.add(now, value)
        self._was_fed = True

    def judge(self, now: Instant) -> None:
        """Compute the value as of `now`, and what follows from it."""
        value = self.window.value(now)
        if value is None:
            self.readings.newest = None
            self._counting_since = None
            # Without readings an error is not known to be over. With readings that have no value it
            # is: no trend leads to the limit any more.
            cause = None if self.window.has_enough(now) else self._cause
            met = [] if cause is None else [cause]
        else:
            self._hold(value, now)
            met = self._count(now)
        self._was_fed = False
        self._judge(met, now)
        self._look_at = self._next_look(now)

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never."""
        return earliest(super().wake_at(), self._look_at)

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

    def _hold(self, value: float, now: Instant) -> None:
        """Hold the value; it is as old as the last reading, or as what time made of it."""
        newest = self.readings.newest
        if newest is None or self._was_fed or value != newest.value:
            since = now if newest is None or newest.value != value else newest.since
            self.readings.newest = HeldReading(value, SOURCE, now, None, None, since)
            self._value_known = value

    def _next_look(self, now: Instant) -> Instant | None:
        changes_at = self.window.changes_at(now)
        if changes_at is None:
            return None
        shown_at = max(changes_at, now + SHOWN_EVERY)
        return earliest(shown_at, *(self._crosses_at(bound, now) for bound in self.settings.bounds))

    def _crosses_at(self, bound: Bound, now: Instant) -> Instant | None:
        limit = bound.clear_limit if bound is self._cause else float(bound.threshold)
        threshold = Threshold(limit, above=bound.comparison is Comparison.ABOVE)
        at = self.window.crosses_at(threshold, now)
        return None if at is None else max(at, now + self._patience)
