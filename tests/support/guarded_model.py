"""The robot of D4.8 with guards on its modes."""

from domain.conditions.condition import Condition
from domain.parts.mode_settings import ModeSettings, TransitionSettings
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName
from domain.timebase import seconds
from tests.support.models import ACTUATION, ARM, BASE, PERFORMANCE, actuation_model

CHARGED = "battery_level >= 0.3"
COOL = "temperature < 50"


def guarded_model(
    part: PartName = ACTUATION,
    mode: ModeName = PERFORMANCE,
    *,
    requires: tuple[str, ...] = (CHARGED,),
    invariants: tuple[str, ...] = (COOL,),
    grace_s: float = 0.0,
    transition: TransitionSettings | None = None,
) -> SmhModel:
    """Return a robot one of whose modes has guards; its base goes first, then its arm."""
    model = actuation_model()
    settings = ModeSettings(
        tuple(map(Condition, requires)),
        tuple(map(Condition, invariants)),
        seconds(grace_s),
        transition=transition or TransitionSettings({ARM: (BASE,)} if part == ACTUATION else {}),
    )
    return SmhModel(model.nodes, model.systems, {part: {mode: settings}})
