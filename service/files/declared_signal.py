"""Settings of one signal, and those that declare a further one: read, or computed."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import Field, model_validator

from domain.errors import InvalidValueError
from domain.health.signals import (
    Bound,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    stale_error,
)
from domain.snapshot import Severity
from domain.state_and_mode import PartName
from domain.timebase import Duration, seconds
from domain.windows.settings import Statistic
from service.files.mode_limits_block import LimitKeys, ModeLimitKeys, mode_limits
from service.files.monitor_block import MonitorKeys, unit_of
from service.files.settings_block import Number, Seconds, SettingsBlock
from service.files.source_block import SourceBlock

_ErrorName: TypeAlias = Annotated[str, Field(pattern=r"^[A-Z][A-Z0-9_]{0,63}$")]

STALE_BETWEEN = "stale_after_s is shorter than the period of the source"

_OF_READINGS = ("minimum", "maximum", "source", "stale_after_s")
"""Keys of signals that are read; a monitor is as fresh as the clock."""


class AnySignal(SettingsBlock):
    """Settings of every signal."""

    stale_after_s: Seconds | None = None
    """Age in seconds above which a reading is stale; 0 turns staleness off. Default: as set for all
    signals."""
    min_on_s: Seconds | None = None
    """Minimum time in seconds that an error of this signal stays active. Default: 0.2."""
    clear_for_s: Seconds | None = None
    """Time in seconds for which the cause of an error has to be gone before the error clears: it
    calms one that comes and goes. Default: 0."""
    recovery: Literal["automatic", "acknowledge"] | None = None
    """Whether an error clears when its cause is gone, or only after it was acknowledged as well.
    Default: automatic."""
    source: SourceBlock | None = None
    """What the service itself reads the signal from. Default: readings are posted, or come from a
    topic of ROS 2. Without effect in simulations, which open nothing."""

    @model_validator(mode="after")
    def _is_not_always_stale(self) -> Self:
        if self.source is not None and 0 < (self.stale_after_s or 0) < self.source.period_s:
            raise ValueError(f"{STALE_BETWEEN}, {self.source.period_s:g} s")
        return self

    def applied_to(self, settings: SignalSettings) -> SignalSettings:
        """Return `settings` with the values that are set here.

        Raises:
            InvalidValueError: A threshold is out of range, or on the wrong side of the other one.
        """
        return replace(
            settings,
            bounds=tuple(self._bound(bound) for bound in settings.bounds),
            stale_after=_duration(self.stale_after_s, settings.stale_after),
            min_on=_duration(self.min_on_s, settings.min_on),
            clear_for=_duration(self.clear_for_s, settings.clear_for),
            recovery=Recovery(self.recovery) if self.recovery else settings.recovery,
        )

    def _bound(self, bound: Bound) -> Bound:
        return bound


class DeclaredSignal(MonitorKeys, LimitKeys, AnySignal):
    """A further numeric signal and its error condition; with `of` it is a monitor."""

    unit: str = Field(default="", max_length=32)
    """Unit of its values, for display."""
    label: str = Field(default="", max_length=64)
    """Its name in messages. Default: the name of the signal."""
    minimum: Number | None = None
    """A reading below this is rejected."""
    maximum: Number | None = None
    """A reading above this is rejected."""
    error: _ErrorName | None = None
    """Name of its error; requires `above`, `below` or `limits`."""
    for_s: Seconds = 0.0
    """Time in seconds after the first bad reading until the error is raised. A good reading, or a
    stale signal, begins it anew."""
    limits: Annotated[dict[str, ModeLimitKeys], Field(min_length=1)] | None = None
    """Limits by the mode that a part is in: `{drive_base.FAST: {above: 60}, default: {above: 80}}`.
    The first that applies is in force, and changes with the mode. They take the place of `above`
    and `below`."""
    part: str | None = None
    """The system or node whose error it is. Default: the robot's own."""
    severity: Literal["warning", "urgent", "critical", "fatal"] = "critical"
    """How bad the error is. Below critical it sets no bit of the error code, so that the robot is
    not in ERROR; and the signal, once stale, has an error of its own, such as MAP_AGE_STALE."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        is_limited = self.above is not None or self.below is not None
        if is_limited and self.limits is not None:
            raise ValueError("limits take the place of above and below: write them as its default")
        if (self.error is None) is (is_limited or self.limits is not None):
            raise ValueError(
                "error requires above, below or limits, and each of these requires error"
            )
        if self.error is None and self.for_s:
            raise ValueError("for_s requires error")
        if self.minimum is not None and self.maximum is not None and self.minimum > self.maximum:
            raise ValueError("minimum is above maximum")
        return self

    def declared(self, name: str, general: AnySignal, unit: str) -> SignalSettings:
        """Return the settings of the signal for the core.

        Args:
            name: Name of the signal.
            general: Settings of all signals, for those that are not set here.
            unit: Its unit, from `unit_with`.

        Raises:
            InvalidValueError: A threshold is outside of minimum and maximum, or on the wrong side.
        """
        try:
            monitor = self.monitor()
        except InvalidValueError as error:
            raise InvalidValueError(error.message, f"{name}/{error.pointer}") from error
        if monitor is not None:
            self._check_monitor(name)
        spec = SignalSpec(name, SignalKind.NUMBER, unit, self.label, self.minimum, self.maximum)
        settings = SignalSettings(
            spec,
            tuple(self._bounds()),
            part=None if self.part is None else PartName(self.part.lstrip("/")),
            severity=Severity(self.severity),
            monitor=monitor,
            limits=tuple(mode_limits(self.limits or {}, self.error or "", self.for_s)),
        )
        settings = self.applied_to(general.applied_to(settings))
        return settings if monitor is None else replace(settings, stale_after=0)

    def unit_with(self, unit: str) -> str:
        """Return its unit, if the signal that it is computed from has a unit."""
        if self.unit or self.statistic is None:
            return self.unit
        return unit_of(Statistic(self.statistic), unit)

    def _check_monitor(self, name: str) -> None:
        for key in _OF_READINGS:
            if getattr(self, key) is not None:
                words = f"{key} is for signals that are read; {name} is computed"
                raise InvalidValueError(words, f"{name}/{key}")

    def errors(self, name: str) -> Iterator[str]:
        """Yield the names of its errors among all errors; not that of stale data.

        Args:
            name: Name of the signal.
        """
        own = [] if self.error is None else [self.error]
        if not Severity(self.severity).stops_task and self.of is None:
            own.append(stale_error(name))
        for error in own:
            yield error if self.part is None else f"{self.part.lstrip('/')}.{error}"

    def _bounds(self) -> Iterator[Bound]:
        bound = self.bound(self.error or "", self.for_s)
        if bound is not None:
            yield bound


def _duration(own: float | None, usual: Duration) -> Duration:
    return usual if own is None else seconds(own)
