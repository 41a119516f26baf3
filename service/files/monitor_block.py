"""Settings of monitors: signals that are computed from the readings of other ones."""

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from domain.errors import InvalidValueError
from domain.health.signals import MonitorSettings, signal_name
from domain.timebase import seconds
from domain.windows.settings import LEAST_R2, Statistic, Threshold, WindowSettings
from service.files.settings_block import Number, SettingsBlock

_WindowSeconds: TypeAlias = Annotated[float, Field(gt=0, le=86_400, allow_inf_nan=False)]
_StatisticName: TypeAlias = Literal[
    "mean",
    "min",
    "max",
    "std",
    "range",
    "slope",
    "count",
    "rate",
    "gap",
    "age",
    "percentile",
    "stuck_for",
    "time_to_limit",
]

SECONDS_OF = frozenset({Statistic.GAP, Statistic.AGE, Statistic.STUCK_FOR, Statistic.TIME_TO_LIMIT})
"""Statistics that are times."""


class ReachedLimit(SettingsBlock):
    """The limit that `time_to_limit` runs to; one of the two."""

    above: Number | None = None
    """Time until the signal is above this."""
    below: Number | None = None
    """Time until the signal is below this."""


class MonitorKeys(SettingsBlock):
    """The settings that make a declared signal a monitor."""

    of: str | None = None
    """The signal that this one is computed from; it may be a monitor itself. No readings of this
    one are taken."""
    statistic: _StatisticName | None = None
    """What is computed: `mean`, `min`, `max`, `std` (of the population), `range`, `slope` (least
    squares, per second), `count`, `rate` (readings per second of the window), `gap` (the longest
    time between two readings, the one until now included), `age` (of the newest reading),
    `percentile`, `stuck_for` (seconds since the value last changed) or `time_to_limit` (seconds, by
    the slope)."""
    window_s: _WindowSeconds | None = None
    """Over the readings of the last so many seconds."""
    window_n: Annotated[int, Field(ge=1)] | None = None
    """Or over so many of the last readings."""
    min_n: Annotated[int, Field(ge=1)] | None = None
    """With fewer readings in the window the value is unknown. Without effect for `count`, `rate`,
    `gap` and `age`, which are known once the window has passed. Default: 2."""
    q: Annotated[float, Field(ge=0, le=100)] | None = None
    """Which percentile, from 0 to 100."""
    limit: ReachedLimit | None = None
    """The limit of `time_to_limit`."""
    min_r2: Annotated[float, Field(ge=0, le=1)] = LEAST_R2
    """If a line explains less than this share of the variance, `time_to_limit` is unknown."""

    def monitor(self) -> MonitorSettings | None:
        """Return what is computed; None: this is no monitor.

        Raises:
            InvalidValueError: Keys do not fit together; `pointer` is the one to change.
        """
        if self.of is None:
            for key in sorted(MonitorKeys.model_fields.keys() & self.model_fields_set):
                raise InvalidValueError(f"{key} is for monitors, which have `of`", key)
            return None
        if self.statistic is None:
            raise InvalidValueError("a monitor needs a statistic", "of")
        window = WindowSettings(
            statistic=Statistic(self.statistic),
            length=None if self.window_s is None else seconds(self.window_s),
            size=self.window_n,
            min_n=min(2, self.window_n or 2) if self.min_n is None else self.min_n,
            q=self.q,
            limit=self._threshold(),
            min_r2=self.min_r2,
        )
        return MonitorSettings(signal_name(self.of), window)

    def _threshold(self) -> Threshold | None:
        if self.limit is None:
            return None
        above, below = self.limit.above, self.limit.below
        if above is not None and below is None:
            return Threshold(above, above=True)
        if below is not None and above is None:
            return Threshold(below, above=False)
        raise InvalidValueError("limit needs either above or below", "limit")


def unit_of(statistic: Statistic, unit: str) -> str:
    """Return the unit of a statistic of a signal with a unit."""
    if statistic in SECONDS_OF:
        return "s"
    if statistic is Statistic.RATE:
        return "Hz"
    if statistic is Statistic.COUNT:
        return ""
    return f"{unit or '1'}/s" if statistic is Statistic.SLOPE else unit
