"""What makes a robot stop: the readings that are bad, and how long they have to be."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

from domain.health.signals import ESTOP, ESTOP_SIGNAL, STALE_DATA, CountsFrom, default_signals

Settings: TypeAlias = Mapping[str, Mapping[str, Any]]
"""Settings of each signal, as `GET /signals` has them."""

GOOD: Mapping[str, float | bool | str] = MappingProxyType(
    {
        "battery_level": 1.0,
        ESTOP_SIGNAL: False,
        "gps_accuracy": 0.0,
        "signal_strength": "CONNECTED",
        "temperature": 20.0,
    }
)
"""A good reading of each signal."""


@dataclass(frozen=True, slots=True)
class Trigger:
    """What raises one error."""

    error: str
    signal: str
    bad: float | bool | str | None
    """The bad reading; None: the readings end."""
    persistence_key: str = "for_s"
    """The setting of the signal that holds the persistence."""
    counts_from: CountsFrom = CountsFrom.FIRST_BAD
    """Where the persistence begins."""

    def persistence_s(self, settings: Settings) -> float:
        """Return how long the condition must last until the error is raised, s."""
        return float(settings[self.signal][self.persistence_key])

    def min_on_s(self, settings: Settings) -> float:
        """Return how long the error stays active at least, s."""
        return float(settings[self.signal]["min_on_s"])


_LAST_GOOD = CountsFrom.LAST_GOOD

TRIGGERS: Mapping[str, Trigger] = MappingProxyType(
    {
        trigger.error: trigger
        for trigger in (
            Trigger(ESTOP, ESTOP_SIGNAL, bad=True),
            Trigger("BATTERY_LOW", "battery_level", 0.0),
            Trigger("TEMPERATURE_HIGH", "temperature", 150.0),
            Trigger(STALE_DATA, "battery_level", None, "stale_after_s", _LAST_GOOD),
            Trigger("SIGNAL_LOST", "signal_strength", "NOT_CONNECTED", "lost_for_s", _LAST_GOOD),
            Trigger("GPS_LOST", "gps_accuracy", 1000.0, "for_s", _LAST_GOOD),
            Trigger("SIGNAL_LOW", "signal_strength", "LOW_SIGNAL", "low_for_s", _LAST_GOOD),
        )
    }
)
"""By error, the fastest first."""


def changed_settings(settings: Settings) -> Iterator[str]:
    """Yield in words which times differ from the defaults, since the figures depend on them."""
    for default in default_signals():
        name = default.spec.name
        for key, usual in default.facts().items():
            if key.endswith("_s") and (now := settings[name].get(key)) != usual:
                yield f"{name}.{key} is {now:g} (default {usual:g})"
