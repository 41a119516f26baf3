"""The last readings of a signal by source, and which late readings are rejected.

The age of a reading counts from its arrival. The sender's stamp only orders its readings.
"""

from dataclasses import dataclass

from domain.health.signals import SignalSettings
from domain.inputs import Reading, SignalValue
from domain.timebase import Duration, Instant, seconds

MAX_SKEW = seconds(1.0)
"""If a stamp is further from our clock than this, one of the clocks is wrong."""

MAX_QUIET_SOURCES = 64
"""Largest number of sources kept that do not press a stop; the latest ones are kept."""

MAX_PRESSING_SOURCES = 1_000
"""Beyond this number, further sources that press a stop share one entry that nobody releases."""

_FURTHER_SOURCES = "further sources"


@dataclass(frozen=True, slots=True)
class HeldReading:
    """The last reading of one source."""

    value: SignalValue
    source: str
    received_at: Instant
    stamp: Instant | None
    newest_stamp: Instant | None
    """Newest stamp of this source; stamps too far ahead of our clock do not count."""
    since: Instant
    """When the source first read this value without another one in between."""

    @property
    def skewed(self) -> bool:
        """Tell whether the sender's clock differs from ours by more than a second."""
        return self.stamp is not None and abs(self.stamp - self.received_at) > MAX_SKEW


class HeldReadings:
    """The readings held of one signal.

    All sources of a signal measure the same quantity, so the last reading counts. Sources of a stop
    are kept apart: the stop is pressed while one of them presses it, and the stamps of each source
    are ordered separately.
    """

    def __init__(self, settings: SignalSettings) -> None:
        self._settings = settings
        self._by_source: dict[str, HeldReading] = {}
        self.newest: HeldReading | None = None
        """The reading that arrived last, from any source."""

    def copy(self) -> "HeldReadings":
        """Return a copy for a trial."""
        copy = HeldReadings(self._settings)
        copy._by_source = dict(self._by_source)
        copy.newest = self.newest
        return copy

    @property
    def value(self) -> SignalValue | None:
        """Return the value in force: the last one, or true while a source presses a stop."""
        if self.pressing:
            return True
        return None if self.newest is None else self.newest.value

    @property
    def pressing(self) -> tuple[HeldReading, ...]:
        """Return the readings that press a stop, the oldest first; empty for other signals."""
        if not self._settings.spec.is_stop:
            return ()
        pressing = [held for held in self._by_source.values() if held.value is True]
        return tuple(sorted(pressing, key=lambda held: (held.since, held.source)))

    def behind(self, reading: Reading, source: str) -> Duration | None:
        """Return by how much a reading is too old; None: it is accepted.

        A worse value is accepted however late it is, and a pressed stop is never rejected.
        """
        held = self._by_source.get(self._key(source))
        if held is None or held.newest_stamp is None or reading.stamp is None:
            return None
        if reading.stamp >= held.newest_stamp:
            return None
        presses = self._settings.spec.is_stop and reading.value is True
        if presses or self._settings.is_worse(reading.value, held.value):
            return None
        return held.newest_stamp - reading.stamp

    def take(self, reading: Reading, source: str, now: Instant) -> None:
        """Hold a checked reading.

        Args:
            reading: Must have passed `behind`.
            source: Who measured.
            now: When it arrived.
        """
        key = self._key(source)
        if reading.value is True and key not in self._by_source and self._is_full:
            # No source has an empty name, so none can release this entry.
            key, source = "", _FURTHER_SOURCES
        # Appended at the end, so that the dictionary stays in order of arrival.
        held = self._by_source.pop(key, None)
        stamps = [] if held is None or held.newest_stamp is None else [held.newest_stamp]
        if reading.stamp is not None and reading.stamp <= now + MAX_SKEW:
            stamps.append(reading.stamp)
        self.newest = self._by_source[key] = HeldReading(
            value=reading.value,
            source=source,
            received_at=now,
            stamp=reading.stamp,
            newest_stamp=max(stamps, default=None),
            since=held.since if held is not None and held.value == reading.value else now,
        )
        self._forget_long_quiet_source()

    def _key(self, source: str) -> str:
        return source if self._settings.spec.is_stop else ""

    @property
    def _is_full(self) -> bool:
        return len(self._by_source) >= MAX_PRESSING_SOURCES + MAX_QUIET_SOURCES

    def _forget_long_quiet_source(self) -> None:
        """Bound the memory against senders that invent source names."""
        quiet = [key for key, held in self._by_source.items() if held.value is not True]
        if len(quiet) > MAX_QUIET_SOURCES:
            del self._by_source[quiet[0]]
