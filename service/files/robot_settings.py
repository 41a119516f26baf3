"""What can be set about a robot besides its model: signals, nodes, deadlines.

The same keys are in a robot file and in the `robot` of a simulation. What is left out keeps the
value that the core gives it.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, model_validator

from domain.health.signals import (
    STALE_DATA,
    Comparison,
    Condition,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.timebase import Duration, seconds

Seconds: TypeAlias = Annotated[float, Field(ge=0, le=86_400, allow_inf_nan=False)]
Number: TypeAlias = Annotated[float, Field(allow_inf_nan=False)]

_SignalName: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,63}$")]
_ErrorName: TypeAlias = Annotated[str, Field(pattern=r"^[A-Z][A-Z0-9_]{0,63}$")]


class SettingsBlock(BaseModel):
    """A block of settings: strict, frozen, and without keys that mean nothing."""

    model_config = ConfigDict(
        strict=True, extra="forbid", frozen=True, use_attribute_docstrings=True
    )


class AnySignal(SettingsBlock):
    """What can be set about every signal."""

    stale_after_s: Seconds | None = None
    """A reading older than this, in seconds, is stale; 0: readings never are. Left out: as for all
    signals."""
    min_on_s: Seconds | None = None
    """An error of this signal stays on for at least so many seconds. Left out: 0.2."""
    recovery: Literal["automatic", "acknowledge"] | None = None
    """Whether an error ends with its cause, or only once somebody acknowledged it too. Left out:
    automatic."""

    def applied_to(self, settings: SignalSettings) -> SignalSettings:
        """Return `settings` with what is set here.

        Raises:
            InvalidValueError: A threshold cannot be reached, or is on the wrong side of the other.
        """
        return replace(
            settings,
            conditions=tuple(self._condition(condition) for condition in settings.conditions),
            stale_after=_duration(self.stale_after_s, settings.stale_after),
            min_on=_duration(self.min_on_s, settings.min_on),
            recovery=Recovery(self.recovery) if self.recovery else settings.recovery,
        )

    def _condition(self, condition: Condition) -> Condition:
        return condition


class NumberSignal(AnySignal):
    """What can be set about a number with a threshold."""

    threshold: Number | None = None
    """Beyond this the value is an error, in the unit of the signal."""
    clear_threshold: Number | None = None
    """Where the error ends once it is on, in the unit of the signal. Left out: at the threshold."""
    for_s: Seconds | None = None
    """For how many seconds after the last good reading the value has to be bad."""

    def _condition(self, condition: Condition) -> Condition:
        threshold = condition.threshold if self.threshold is None else self.threshold
        return replace(
            condition,
            threshold=threshold,
            clear_threshold=self.clear_threshold,
            for_=_duration(self.for_s, condition.for_),
        )


class StrengthSignal(AnySignal):
    """What can be set about the signal strength, which has two errors."""

    lost_for_s: Seconds | None = None
    """For how many seconds after the last CONNECTED there has to be NOT_CONNECTED. Left out: 10."""
    low_for_s: Seconds | None = None
    """For how many seconds after the last CONNECTED there has to be LOW_SIGNAL. Left out: 20."""
    for_s: Seconds | None = None
    """Both times at once, as far as they are not set by themselves."""

    def _condition(self, condition: Condition) -> Condition:
        own = self.lost_for_s if condition.key == "lost" else self.low_for_s
        if own is None:
            own = self.for_s
        return replace(condition, for_=_duration(own, condition.for_))


class DeclaredSignal(AnySignal):
    """A further signal: a number, and when it is an error."""

    unit: str = Field(default="", max_length=32)
    """Unit of its values, for showing."""
    label: str = Field(default="", max_length=64)
    """Its name in a sentence. Left out: the name itself."""
    minimum: Number | None = None
    """A reading below this is refused."""
    maximum: Number | None = None
    """A reading above this is refused."""
    error: _ErrorName | None = None
    """Name of its error; needs `above` or `below`."""
    above: Number | None = None
    """A value above this is the error."""
    below: Number | None = None
    """A value below this is the error."""
    clear_threshold: Number | None = None
    """Where the error ends once it is on. Left out: at `above` or `below`."""
    for_s: Seconds = 0.0
    """For how many seconds after the last good reading the value has to be bad."""

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        limits = sum(limit is not None for limit in (self.above, self.below))
        if limits > 1:
            raise ValueError("above and below exclude each other")
        if (self.error is None) != (limits == 0):
            raise ValueError("an error needs above or below, and above and below need an error")
        if limits == 0 and (self.clear_threshold is not None or self.for_s):
            raise ValueError("clear_threshold and for_s need an error")
        if self.minimum is not None and self.maximum is not None and self.minimum > self.maximum:
            raise ValueError("minimum is above maximum")
        return self

    def declared(self, name: str, general: AnySignal) -> SignalSettings:
        """Return the signal as the core knows it; `general` holds for what is not set here.

        Raises:
            InvalidValueError: A threshold is outside of minimum and maximum, or on the wrong side.
        """
        spec = SignalSpec(
            name, SignalKind.NUMBER, self.unit, self.label, self.minimum, self.maximum
        )
        settings = SignalSettings(spec, tuple(self._conditions()))
        return self.applied_to(general.applied_to(settings))

    def _conditions(self) -> Iterator[Condition]:
        comparison = Comparison.BELOW if self.above is None else Comparison.ABOVE
        threshold = self.below if self.above is None else self.above
        if self.error is not None and threshold is not None:
            for_ = seconds(self.for_s)
            yield Condition(self.error, comparison, threshold, self.clear_threshold, for_)


class SignalsBlock(SettingsBlock):
    """The signals; every other key declares a further one."""

    model_config = ConfigDict(extra="allow")
    __pydantic_extra__: dict[_SignalName, DeclaredSignal]  # type: ignore[mutable-override]

    stale_after_s: Seconds | None = None
    """Of all signals that say nothing else, in seconds; 0 turns staleness off. Left out: 2."""
    battery_level: NumberSignal = NumberSignal()
    """Charge from 0 to 1; BATTERY_LOW below 0.5."""
    estop: AnySignal = AnySignal()
    """The robot's own stop button; ESTOP while it is pressed."""
    gps_accuracy: NumberSignal = NumberSignal()
    """In mm; GPS_LOST above 200 for 15 s."""
    signal_strength: StrengthSignal = StrengthSignal()
    """SIGNAL_LOST and SIGNAL_LOW."""
    temperature: NumberSignal = NumberSignal()
    """In degrees Celsius; TEMPERATURE_HIGH above 55."""

    def to_domain(self) -> tuple[SignalSettings, ...]:
        """Return all signals as the core knows them; see `RobotSettings.to_signal_settings`."""
        general = AnySignal(stale_after_s=self.stale_after_s)
        usual = (
            getattr(self, settings.spec.name).applied_to(general.applied_to(settings))
            for settings in default_signals()
        )
        further = (signal.declared(name, general) for name, signal in self.further.items())
        return (*usual, *further)

    @property
    def further(self) -> dict[str, DeclaredSignal]:
        """Return the declared signals by name."""
        return self.__pydantic_extra__

    @model_validator(mode="after")
    def _errors_have_names_of_their_own(self) -> Self:
        taken = {STALE_DATA} | {c.error for s in default_signals() for c in s.conditions}
        for name, signal in self.further.items():
            if signal.error in taken:
                raise ValueError(f"{signal.error} of {name} is the name of another error")
            taken |= {signal.error} if signal.error else set()
        return self


class NodeBlock(SettingsBlock):
    """A node. All but `on_return` matters only when it is simulated, as a small one if left out."""

    on_return: Literal["leave", "restore"] = "leave"
    """What happens when it becomes reachable and is not in what was asked of it: nothing, or a
    change that brings it there."""
    configure_s: Seconds | None = None
    """How long its callback takes, in seconds."""
    activate_s: Seconds | None = None
    """How long its callback takes, in seconds."""
    deactivate_s: Seconds | None = None
    """How long its callback takes, in seconds."""
    cleanup_s: Seconds | None = None
    """How long its callback takes, in seconds."""
    shutdown_s: Seconds | None = None
    """How long its callback takes, in seconds."""
    set_parameters_s: Seconds | None = None
    """How long it takes to set parameters, in seconds."""
    fault: Literal["slow", "refuse", "fail", "error", "silent", "die"] | None = None
    """What is wrong with it from the start."""


class ChangesBlock(SettingsBlock):
    """How long a step of a change may take before the node's real state is asked."""

    transition_deadline_s: Seconds = 10.0
    """For one lifecycle transition, in seconds."""
    parameters_deadline_s: Seconds = 2.0
    """For setting parameters, in seconds."""


def _duration(own: float | None, usual: Duration) -> Duration:
    return usual if own is None else seconds(own)
