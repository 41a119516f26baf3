"""A slow model of health that is easy to believe: it looks again at every single instant.

It knows neither timers nor wake-up times. At each nanosecond it asks the whole history what holds.
Only for signals of which a value meets one bound at most, as those of smart_polaris.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest

from domain.health.signals import (
    STALE_DATA,
    Bound,
    Comparison,
    CountsFrom,
    Recovery,
    SignalSettings,
)
from domain.inputs import Reading, Readings
from domain.timebase import Instant

SECOND = 1_000_000_000


@dataclass(frozen=True)
class Moment:
    """What holds at one instant, after everything that happened at it so far."""

    errors: frozenset[tuple[str, str]]
    """Signal and error."""
    pending: Mapping[str, tuple[str, Instant] | None]
    """By signal, the error that will be raised, and since when its time counts."""
    stale: frozenset[str]


@dataclass
class _Arrived:
    at: Instant
    source: str
    reading: Reading
    was_good: bool = False


@dataclass
class _Signal:
    settings: SignalSettings
    start: Instant
    arrived: list[_Arrived] = field(default_factory=list)
    engaged: bool = False
    cause: Bound | None = None
    on: str | None = None
    on_since: Instant = 0
    acknowledged: bool = False
    stale: bool = False
    stale_on: bool = False
    stale_since: Instant = 0
    counting: Instant | None = None

    def __post_init__(self) -> None:
        self.stale = self.stale_on = self.settings.stale_after > 0
        # So long ago that its least time is over.
        self.stale_since = self.start - self.settings.min_on

    def of_source(self, source: str) -> list[_Arrived]:
        """Return what counts for the order of stamps."""
        return [a for a in self.arrived if a.source == source or not self.settings.spec.is_stop]

    def value(self) -> object:
        if not self.settings.spec.is_stop:
            return self.arrived[-1].reading.value if self.arrived else None
        last_of_each = {a.source: a.reading.value for a in self.arrived}
        return any(last_of_each.values()) if last_of_each else None

    def bad(self) -> Bound | None:
        """Return the bound that the value read meets."""
        value = self.value()
        for bound in self.settings.bounds:
            limit = bound.threshold
            if bound is self.cause and bound.clear_threshold is not None:
                limit = bound.clear_threshold
            if value is None:
                continue
            if bound.comparison is Comparison.EQUAL:
                is_met = value == limit
            elif bound.comparison is Comparison.ABOVE:
                is_met = float(str(value)) > float(limit)
            else:
                is_met = float(str(value)) < float(limit)
            if is_met:
                return bound
        return None

    def counts_since(self, now: Instant) -> Instant | None:
        """Return from when "for" counts; None: nothing counts."""
        if self.settings.counts_from is CountsFrom.LAST_GOOD:
            return max((a.at for a in self.arrived if a.was_good), default=self.start)
        first_bad = None
        for arrived, following in zip_longest(self.arrived, self.arrived[1:]):
            if arrived.was_good:
                first_bad = None
            elif first_bad is None:
                first_bad = arrived.at
            limit, until = self.settings.stale_after, now if following is None else following.at
            if limit and until - arrived.at > limit:
                first_bad = None
        return first_bad

    def look(self, now: Instant) -> None:
        bad = self.settings.bounds[0] if self.engaged else self.bad()
        had_cause = self.cause
        self.counting = since = self.counts_since(now)
        is_due = bad is not None and since is not None and now - since >= bad.for_
        if bad is None:
            self.cause = None
        elif self.engaged or self.cause is not None or is_due:
            self.cause = bad
        if self.cause is not None:
            if self.cause is not had_cause:
                self.acknowledged = False
            if self.on != self.cause.error:
                self.on, self.on_since = self.cause.error, now
        elif self._may_end() and now - self.on_since >= self.settings.min_on:
            self.on = None
        self._look_at_age(now)

    def _may_end(self) -> bool:
        return self.settings.recovery is Recovery.AUTOMATIC or self.acknowledged

    def _look_at_age(self, now: Instant) -> None:
        limit = self.settings.stale_after
        self.stale = limit > 0 and (not self.arrived or now - self.arrived[-1].at > limit)
        if self.stale and not self.stale_on:
            self.stale_on, self.stale_since = True, now
        if not self.stale and now - self.stale_since >= self.settings.min_on:
            self.stale_on = False

    def pending(self) -> tuple[str, Instant] | None:
        bad = None if self.engaged else self.bad()
        if bad is None or self.cause is not None or self.counting is None:
            return None
        return bad.error, self.counting


class HealthReference:
    """The signals of a robot, looked at one nanosecond after the other."""

    def __init__(self, settings: Sequence[SignalSettings], start: Instant) -> None:
        self._now = start
        self._signals = {item.spec.name: _Signal(item, start) for item in settings}

    def advance_to(self, now: Instant) -> list[tuple[Instant, Moment]]:
        """Look at every instant up to now, the present one again; return what was seen."""
        seen = []
        for instant in range(self._now, now + 1):
            for signal in self._signals.values():
                signal.look(instant)
            seen.append((instant, self.moment()))
        self._now = now
        return seen

    def refuses(self, readings: Readings) -> bool:
        """Tell whether one of the readings is older than one before it, and no worse."""
        trial: dict[str, list[_Arrived]] = {}
        for reading in readings.items:
            signal = self._signals[reading.signal]
            mine = [*signal.of_source(readings.source), *trial.get(reading.signal, [])]
            counted = [
                arrived.reading.stamp
                for arrived in mine
                if arrived.reading.stamp is not None
                and arrived.reading.stamp - arrived.at <= SECOND
            ]
            is_late = reading.stamp is not None and reading.stamp < max(
                counted, default=-(SECOND**2)
            )
            if is_late and not self._is_worse(signal, reading.value, mine[-1].reading.value):
                return True
            item = _Arrived(self._now, readings.source, reading)
            trial.setdefault(reading.signal, []).append(item)
        return False

    def receive(self, readings: Readings) -> None:
        """Take readings that arrive now."""
        for reading in readings.items:
            signal = self._signals[reading.signal]
            item = _Arrived(self._now, readings.source, reading)
            signal.arrived.append(item)
            item.was_good = signal.bad() is None
            signal.look(self._now)

    def engage(self, engaged: bool) -> None:
        """Engage or release the emergency stop."""
        self._signals["estop"].engaged = engaged
        self._signals["estop"].look(self._now)

    def acknowledge(self, error: str) -> None:
        """Acknowledge an error."""
        for signal in self._signals.values():
            if signal.on == error:
                signal.acknowledged = True
                signal.look(self._now)

    def moment(self) -> Moment:
        """Return what holds now."""
        signals = self._signals
        on = {(name, signal.on) for name, signal in signals.items() if signal.on is not None}
        on |= {(name, STALE_DATA) for name, signal in signals.items() if signal.stale_on}
        return Moment(
            frozenset(on),
            {name: signal.pending() for name, signal in signals.items()},
            frozenset(name for name, signal in signals.items() if signal.stale),
        )

    @staticmethod
    def _is_worse(signal: _Signal, value: object, held: object) -> bool:
        if signal.settings.spec.is_stop:
            return value is True
        if signal.settings.spec.members:
            order = signal.settings.spec.members
            return order.index(str(value)) > order.index(str(held))
        if signal.settings.bounds[0].comparison is Comparison.BELOW:
            return float(str(value)) < float(str(held))
        return float(str(value)) > float(str(held))
