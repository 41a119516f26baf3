"""Robots whose modes have invariants and fallbacks, and what a story of them needs."""

from dataclasses import replace

from domain.conditions.condition import Condition
from domain.health.signals import default_signals
from domain.inputs import SignalValue
from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import SmhModel
from domain.snapshot import ErrorKey, ErrorView
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from tests.support.models import ACTUATION, MODERATE, PERFORMANCE, actuation_model
from tests.support.ruled_robot import RuledRobot

COOL, CHARGED, FULL = "temperature < 50", "battery_level >= 0.2", "battery_level >= 0.4"


def guarded(
    *invariants: str,
    fallback: str | None = None,
    requires: tuple[str, ...] = (),
    grace_s: float = 0.0,
) -> ModeSettings:
    """Return the settings of a mode that has invariants."""
    return ModeSettings(
        tuple(map(Condition, requires)),
        tuple(map(Condition, invariants)),
        seconds(grace_s),
        None if fallback is None else ModeName(fallback),
    )


def with_settings(model: SmhModel, part: PartName, **modes: ModeSettings) -> SmhModel:
    """Return a model in which modes of a part have settings."""
    own = {ModeName(mode): settings for mode, settings in modes.items()}
    return SmhModel(model.nodes, model.systems, {**model.mode_settings, part: own})


def falling_model(grace_s: float = 0.0) -> SmhModel:
    """Return the robot of D4.8: PERFORMANCE falls back to MODERATE, that to `__DEFAULT__`.

    PERFORMANCE is for a cool robot with a full battery, MODERATE for a charged one.
    """
    performance = guarded(COOL, requires=(FULL,), fallback=MODERATE, grace_s=grace_s)
    moderate = guarded(CHARGED, requires=(FULL,), fallback=DEFAULT_MODE)
    return with_settings(actuation_model(), ACTUATION, PERFORMANCE=performance, MODERATE=moderate)


def lasting_signals() -> SupervisionSettings:
    """Return settings in which a reading holds until the next one."""
    signals = tuple(replace(signal, stale_after=0) for signal in default_signals())
    return SupervisionSettings(signals)


class FallingRobot(RuledRobot):
    """A robot whose readings hold until the next ones."""

    def __init__(
        self, model: SmhModel | None = None, settings: SupervisionSettings | None = None
    ) -> None:
        super().__init__(model or falling_model(), settings or lasting_signals())

    def reads(self, wait_s: float = 0.5, **values: SignalValue) -> "FallingRobot":
        """Hand in readings, and let that take effect."""
        self.read(**values)
        self.advance(wait_s)
        return self

    def performing(self) -> "FallingRobot":
        """Reach PERFORMANCE."""
        self.ask_mode(ACTUATION, PERFORMANCE)
        self.advance(2)
        assert self.actual(ACTUATION) == "active.PERFORMANCE"
        return self

    def fallen(self) -> "FallingRobot":
        """Reach PERFORMANCE, and become too hot for it."""
        self.performing().reads(temperature=52.0)
        assert self.mode() == "MODERATE invariant"
        return self

    def mode(self, part: str = ACTUATION) -> str:
        """Return the mode of the target in force, with who set it, if it was not requested."""
        pursued = self.pursued(part)
        label = pursued.mode or str(pursued.state)
        return label if pursued.because == "requested" else f"{label} {pursued.because}"

    def broken(self, part: str = ACTUATION) -> str:
        """Return the message of INVARIANT_BROKEN of a part; empty: it is not on."""
        error: ErrorView = self.core.error(ErrorKey(PartName(part), "INVARIANT_BROKEN"))
        return error.message if error.state.is_on else ""
