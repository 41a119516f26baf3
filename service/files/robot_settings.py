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
    SignalSettings,
    default_signals,
    signal_name,
)
from domain.reactions.settings import RuleSettings
from domain.timebase import Duration, seconds
from service.files.checkpoints_block import CheckpointsBlock
from service.files.declared_signal import STALE_BETWEEN, AnySignal, DeclaredSignal
from service.files.process_block import ProcessBlock
from service.files.settings_block import Number, Seconds, SettingsBlock, bare_names
from service.files.source_block import MISSED_PERIODS, SourceBlock

_SignalName: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,63}$")]
_DEFAULT_UNITS = {settings.spec.name: settings.spec.unit for settings in default_signals()}


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
            signal.declared(name, self._general(signal), self._unit_of(name))
            for name, signal in self.further.items()
        )
        return (*usual, *further)

    def _unit_of(self, name: str) -> str:
        """Return the unit of a signal; that of a monitor follows from what it is computed from."""
        way = self._way_to_root(name)
        unit = _DEFAULT_UNITS.get(way[-1], "")
        for step in reversed(way):
            if step in self.further:
                unit = self.further[step].unit_with(unit)
        return unit

    def root_of(self, name: str) -> str:
        """Return the signal whose readings a monitor is computed from, maybe through others."""
        return self._way_to_root(name)[-1]

    def _way_to_root(self, name: str) -> list[str]:
        way = [name]
        while (signal := self.further.get(way[-1])) is not None and signal.of is not None:
            way.append(signal_name(signal.of))
            if way[-1] in way[:-1]:
                break  # In a circle, which is told elsewhere.
        return way

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
                raise ValueError(f"{STALE_BETWEEN} of {name}, {source.period_s:g} s")
        return self

    @model_validator(mode="after")
    def _errors_have_names_of_their_own(self) -> Self:
        taken = {STALE_DATA} | {c.error for s in default_signals() for c in s.bounds}
        for name, signal in self.further.items():
            for error in signal.errors(name):
                if error in taken:
                    raise ValueError(f"{error} of {name} is already the name of another error")
                taken.add(error)
        return self


class NodeBlock(SettingsBlock):
    """Settings of a node.

    Beside `on_return` and `checkpoints`, `process` is for real nodes, and the others for simulated
    ones.
    """

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
    process: ProcessBlock | None = None
    """The program of the node, which the service runs on this computer. Default: somebody else
    starts it."""


class ChangesBlock(SettingsBlock):
    """Deadlines of the steps of changes; after a deadline the node's actual state is queried."""

    transition_deadline_s: Seconds = 10.0
    """Deadline of a lifecycle transition, in seconds."""
    parameters_deadline_s: Seconds = 2.0
    """Deadline of setting parameters, in seconds."""


class RulesBlock(SettingsBlock):
    """When rules of the model act."""

    grace_s: Seconds = 1.0
    """How long a deviation must last before a rule acts on it, and how long its cause must be gone
    before the system returns to its requested target, in seconds."""

    def to_domain(self) -> RuleSettings:
        """Return these settings for the core."""
        return RuleSettings(seconds(self.grace_s))


def _duration(own: float | None, usual: Duration) -> Duration:
    return usual if own is None else seconds(own)
