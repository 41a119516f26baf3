"""Settings of a robot besides its model: signals, nodes, deadlines.

A robot file and the `robot` of a simulation have the same keys. Omitted keys keep the default of
the core.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import ConfigDict, Field, model_validator

from domain.health.signals import (
    STALE_DATA,
    Bound,
    Comparison,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.timebase import Duration, seconds
from service.files.checkpoints_block import CheckpointsBlock
from service.files.settings_block import Number, Seconds, SettingsBlock, bare_names
from service.files.source_block import MISSED_PERIODS, SourceBlock

_SignalName: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,63}$")]
_ErrorName: TypeAlias = Annotated[str, Field(pattern=r"^[A-Z][A-Z0-9_]{0,63}$")]


_STALE_BETWEEN = "stale_after_s is shorter than the period of the source"


class AnySignal(SettingsBlock):
    """Settings of every signal."""

    stale_after_s: Seconds | None = None
    """Age in seconds above which a reading is stale; 0 turns staleness off. Default: as set for all
    signals."""
    min_on_s: Seconds | None = None
    """Minimum time in seconds that an error of this signal stays active. Default: 0.2."""
    recovery: Literal["automatic", "acknowledge"] | None = None
    """Whether an error clears when its cause is gone, or only after it was acknowledged as well.
    Default: automatic."""
    source: SourceBlock | None = None
    """What the service itself reads the signal from. Default: readings are posted, or come from a
    topic of ROS 2. Without effect in simulations, which open nothing."""

    @model_validator(mode="after")
    def _is_not_always_stale(self) -> Self:
        if self.source is not None and 0 < (self.stale_after_s or 0) < self.source.period_s:
            raise ValueError(f"{_STALE_BETWEEN}, {self.source.period_s:g} s")
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
            recovery=Recovery(self.recovery) if self.recovery else settings.recovery,
        )

    def _bound(self, bound: Bound) -> Bound:
        return bound


class NumberSignal(AnySignal):
    """Settings of a numeric signal with a threshold."""

    threshold: Number | None = None
    """Threshold beyond which the value is an error, in the unit of the signal."""
    clear_threshold: Number | None = None
    """Threshold at which an active error clears, in the signal's unit. Default: `threshold`."""
    for_s: Seconds | None = None
    """Time in seconds until the error is raised: for `gps_accuracy` after the last good reading,
    else after the first bad one."""

    def _bound(self, bound: Bound) -> Bound:
        threshold = bound.threshold if self.threshold is None else self.threshold
        return replace(
            bound,
            threshold=threshold,
            clear_threshold=self.clear_threshold,
            for_=_duration(self.for_s, bound.for_),
        )


class StrengthSignal(AnySignal):
    """Settings of the signal strength, which has two errors."""

    lost_for_s: Seconds | None = None
    """Time in seconds after the last CONNECTED until NOT_CONNECTED raises an error. Default: 10."""
    low_for_s: Seconds | None = None
    """Time in seconds after the last CONNECTED until LOW_SIGNAL raises an error. Default: 20."""
    for_s: Seconds | None = None
    """Default of `lost_for_s` and `low_for_s`, in seconds."""

    def _bound(self, bound: Bound) -> Bound:
        own = self.lost_for_s if bound.key == "lost" else self.low_for_s
        if own is None:
            own = self.for_s
        return replace(bound, for_=_duration(own, bound.for_))


class DeclaredSignal(AnySignal):
    """A further numeric signal and its error condition."""

    unit: str = Field(default="", max_length=32)
    """Unit of its values, for display."""
    label: str = Field(default="", max_length=64)
    """Its name in messages. Default: the name of the signal."""
    minimum: Number | None = None
    """A reading below this is rejected."""
    maximum: Number | None = None
    """A reading above this is rejected."""
    error: _ErrorName | None = None
    """Name of its error; requires `above` or `below`."""
    above: Number | None = None
    """A value above this is an error."""
    below: Number | None = None
    """A value below this is an error."""
    clear_threshold: Number | None = None
    """Threshold at which an active error clears. Default: `above` or `below`."""
    for_s: Seconds = 0.0
    """Time in seconds after the first bad reading until the error is raised. A good reading, or a
    stale signal, begins it anew."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        limits = sum(limit is not None for limit in (self.above, self.below))
        if limits > 1:
            raise ValueError("above and below are mutually exclusive")
        if (self.error is None) != (limits == 0):
            raise ValueError("error requires above or below, and above and below require error")
        if limits == 0 and (self.clear_threshold is not None or self.for_s):
            raise ValueError("clear_threshold and for_s require error")
        if self.minimum is not None and self.maximum is not None and self.minimum > self.maximum:
            raise ValueError("minimum is above maximum")
        return self

    def declared(self, name: str, general: AnySignal) -> SignalSettings:
        """Return the settings of the signal for the core.

        Args:
            name: Name of the signal.
            general: Settings of all signals, for those that are not set here.

        Raises:
            InvalidValueError: A threshold is outside of minimum and maximum, or on the wrong side.
        """
        spec = SignalSpec(
            name, SignalKind.NUMBER, self.unit, self.label, self.minimum, self.maximum
        )
        settings = SignalSettings(spec, tuple(self._bounds()))
        return self.applied_to(general.applied_to(settings))

    def _bounds(self) -> Iterator[Bound]:
        comparison = Comparison.BELOW if self.above is None else Comparison.ABOVE
        threshold = self.below if self.above is None else self.above
        if self.error is not None and threshold is not None:
            for_ = seconds(self.for_s)
            yield Bound(self.error, comparison, threshold, self.clear_threshold, for_)


class SignalsBlock(SettingsBlock):
    """Settings of the default signals; every other key declares a further signal."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[_SignalName, DeclaredSignal] = Field(init=False)  # type: ignore[mutable-override]

    stale_after_s: Seconds | None = None
    """Default of `stale_after_s` of all signals, in seconds; 0 turns staleness off. Default: 2."""
    battery_level: NumberSignal = NumberSignal()
    """Charge from 0 to 1; BATTERY_LOW below 0.5."""
    estop: AnySignal = AnySignal()
    """The stop button of the robot; ESTOP while it is pressed."""
    gps_accuracy: NumberSignal = NumberSignal()
    """Position accuracy in mm; GPS_LOST above 200 for 15 s."""
    signal_strength: StrengthSignal = StrengthSignal()
    """Radio connection; SIGNAL_LOST and SIGNAL_LOW."""
    temperature: NumberSignal = NumberSignal()
    """Temperature in degrees Celsius; TEMPERATURE_HIGH above 55."""

    @model_validator(mode="before")
    @classmethod
    def _without_leading_slashes(cls, named: object) -> object:
        # What is no mapping of names is told by the validation that follows.
        return bare_names(named) if isinstance(named, dict) else named

    def to_domain(self) -> tuple[SignalSettings, ...]:
        """Return the settings of all signals; see `RobotSettings.to_signal_settings`."""
        usual = (
            signal.applied_to(self._general(signal).applied_to(settings))
            for signal, settings in self._default_ones()
        )
        further = (
            signal.declared(name, self._general(signal)) for name, signal in self.further.items()
        )
        return (*usual, *further)

    def _general(self, signal: AnySignal) -> AnySignal:
        """Return the settings of all signals; without any, those that suit the source of one."""
        stale_after_s = self.stale_after_s
        if stale_after_s is None and signal.source is not None:
            stale_after_s = MISSED_PERIODS * signal.source.period_s
        return AnySignal(stale_after_s=stale_after_s)

    def _default_ones(self) -> Iterator[tuple[AnySignal, SignalSettings]]:
        for settings in default_signals():
            yield getattr(self, settings.spec.name), settings

    @property
    def sources(self) -> dict[str, SourceBlock]:
        """Return the sources by the names of their signals."""
        default = {settings.spec.name: signal for signal, settings in self._default_ones()}
        named = {**default, **self.further}
        return {name: signal.source for name, signal in named.items() if signal.source is not None}

    @property
    def further(self) -> dict[str, DeclaredSignal]:
        """Return the declared signals by name."""
        return self.__pydantic_extra__

    @model_validator(mode="after")
    def _none_is_always_stale(self) -> Self:
        for name, source in self.sources.items():
            own = getattr(self, name).stale_after_s
            if own is None and 0 < (self.stale_after_s or 0) < source.period_s:
                raise ValueError(f"{_STALE_BETWEEN} of {name}, {source.period_s:g} s")
        return self

    @model_validator(mode="after")
    def _errors_have_names_of_their_own(self) -> Self:
        taken = {STALE_DATA} | {c.error for s in default_signals() for c in s.bounds}
        for name, signal in self.further.items():
            if signal.error in taken:
                raise ValueError(f"{signal.error} of {name} is already the name of another error")
            taken |= {signal.error} if signal.error else set()
        return self


class NodeBlock(SettingsBlock):
    """Settings of a node. All but `on_return` and `checkpoints` apply to simulated nodes only."""

    on_return: Literal["leave", "restore"] = "leave"
    """What happens when the node reappears and is not in its target state and mode: nothing, or a
    change restores it to its target."""
    configure_s: Seconds | None = None
    """Duration of its configure callback, in seconds."""
    activate_s: Seconds | None = None
    """Duration of its activate callback, in seconds."""
    deactivate_s: Seconds | None = None
    """Duration of its deactivate callback, in seconds."""
    cleanup_s: Seconds | None = None
    """Duration of its cleanup callback, in seconds."""
    shutdown_s: Seconds | None = None
    """Duration of its shutdown callback, in seconds."""
    set_parameters_s: Seconds | None = None
    """Duration of setting parameters, in seconds."""
    fault: Literal["slow", "refuse", "fail", "error", "silent", "die"] | None = None
    """Fault of the node from the start."""
    checkpoints: CheckpointsBlock | None = None
    """Places in its program that the node reports by POST /nodes/{node}/checkpoints/{name}, and
    what is expected of them while it is active. Default: none are known."""


class ChangesBlock(SettingsBlock):
    """Deadlines of the steps of changes; after a deadline the node's actual state is queried."""

    transition_deadline_s: Seconds = 10.0
    """Deadline of a lifecycle transition, in seconds."""
    parameters_deadline_s: Seconds = 2.0
    """Deadline of setting parameters, in seconds."""


def _duration(own: float | None, usual: Duration) -> Duration:
    return usual if own is None else seconds(own)
