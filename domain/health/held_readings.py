"""The last readings of a signal by source, and which late readings are rejected.

The age of a reading counts from its arrival. The sender's stamp only orders its readings.
"""

from typing import NamedTuple

from domain.health.signals import SignalSettings
from domain.inputs import Reading, SignalValue
from domain.timebase import Duration, Instant, seconds

MAX_SKEW = seconds(1.0)
"""If a stamp is further from our clock than this, one of the clocks is wrong."""

MAX_SOURCES = 32
"""Largest number of sources that press a stop and are kept apart; as many quiet ones are known."""

FURTHER_SOURCES = "further sources"
"""Source shared by all that come when `MAX_SOURCES` press a stop already."""


class HeldReading(NamedTuple):
    """The last reading of one source; a tuple, since there are thousands a second."""

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

    The number of sources is bounded. While `MAX_SOURCES` press the stop, further ones share one
    source, and until it is released also all that are not known yet: so whoever pressed a stop
    can release it by the name under which it was pressed. The stamps of a shared source are of
    several clocks and are not compared.
    """

    def __init__(self, settings: SignalSettings) -> None:
        self.settings = settings
        self._is_stop = settings.spec.is_stop
        self._by_source: dict[str, HeldReading] = {}
        """Of a stop; the sources of any other signal are not kept apart."""
        self.newest: HeldReading | None = None
        """The reading that arrived last, from any source."""

    def copy(self) -> "HeldReadings":
        """Return a copy for a trial."""
        copy = HeldReadings(self.settings)
        copy._by_source = dict(self._by_source)
        copy.newest = self.newest
        return copy

    @property
    def value(self) -> SignalValue | None:
        """Return the value in force: the last one, or true while a source presses a stop."""
        if self._is_stop and self.pressing:
            return True
        return None if self.newest is None else self.newest.value

    @property
    def pressing(self) -> tuple[HeldReading, ...]:
        """Return the readings that press a stop, the oldest first; empty for other signals."""
        if not self._is_stop:
            return ()
        pressing = [held for held in self._by_source.values() if held.value is True]
        return tuple(sorted(pressing, key=lambda held: (held.since, held.source)))

    def behind(self, reading: Reading, source: str) -> Duration | None:
        """Return by how much a reading is too old; None: it is accepted.

        A worse value is accepted however late it is, and a pressed stop is never rejected.
        """
        if reading.stamp is None:
            return None
        key = self._key(source)
        held = self._by_source.get(key) if self._is_stop else self.newest
        if held is None or held.newest_stamp is None:
            return None
        if key == FURTHER_SOURCES:
            return None
        if reading.stamp >= held.newest_stamp:
            return None
        presses = self.settings.spec.is_stop and reading.value is True
        if presses or self.settings.is_worse(reading.value, held.value):
            return None
        return held.newest_stamp - reading.stamp

    def is_released_by(self, reading: Reading, source: str) -> bool:
        """Tell whether a reading releases the stop that its source presses."""
        held = self._by_source.get(self._key(source))
        return held is not None and held.value is True and reading.value is False

    def take(self, reading: Reading, source: str, now: Instant) -> HeldReading:
        """Hold a checked reading, and return what is held.

        Args:
            reading: Must have passed `behind`.
            source: Who measured.
            now: When it arrived.
        """
        if not self._is_stop:
            self.newest = _held(self.newest, reading, source, now)
            return self.newest
        key = self._key(source)
        if key == FURTHER_SOURCES:
            source = FURTHER_SOURCES
        # Appended at the end, so that the dictionary stays in order of arrival.
        held = _held(self._by_source.pop(key, None), reading, source, now)
        self.newest = self._by_source[key] = held
        self._forget_quiet_source()
        return held

    def _key(self, source: str) -> str:
        """Return under which name the readings of a source of a stop are held."""
        if source in self._by_source:
            return source
        pressing = sum(held.value is True for held in self._by_source.values())
        is_shared = FURTHER_SOURCES in self._by_source or pressing >= MAX_SOURCES
        return FURTHER_SOURCES if is_shared else source

    def _forget_quiet_source(self) -> None:
        """Bound the memory against senders that invent source names."""
        shared = self._by_source.get(FURTHER_SOURCES)
        if shared is not None and shared.value is not True:
            del self._by_source[FURTHER_SOURCES]
        quiet = [key for key, held in self._by_source.items() if held.value is not True]
        if len(quiet) > MAX_SOURCES:
            del self._by_source[quiet[0]]


def _held(held: HeldReading | None, reading: Reading, source: str, now: Instant) -> HeldReading:
    """Return what is held of a reading that takes the place of another one."""
    newest_stamp, since = reading.stamp, now
    if newest_stamp is not None and newest_stamp > now + MAX_SKEW:
        newest_stamp = None
    if held is not None:
        stamp = held.newest_stamp
        if newest_stamp is None or (stamp is not None and stamp > newest_stamp):
            newest_stamp = stamp
        if held.value == reading.value:
            since = held.since
    return HeldReading(reading.value, source, now, reading.stamp, newest_stamp, since)
