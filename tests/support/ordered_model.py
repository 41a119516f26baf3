"""A robot whose parts change in an order, and go back or stop on a failure."""

from collections.abc import Mapping, Sequence
from itertools import pairwise

from domain.parts.mode_settings import ModeSettings, OnFailure, TransitionSettings
from domain.parts.system_model import EVERY_MODE, NodeModel, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, PartName
from domain.timebase import seconds
from tests.support.models import FAST, active

ROBOT = PartName("robot")
NODES = tuple(PartName(f"n{number}") for number in range(1, 6))
IN_A_ROW: Mapping[str, Sequence[str]] = {later: [earlier] for earlier, later in pairwise(NODES)}


def settings(
    after: Mapping[str, Sequence[str]],
    on_failure: OnFailure = OnFailure.CONTINUE,
    deadline_s: float | None = None,
) -> ModeSettings:
    """Return the settings of a mode with this order."""
    waits = {PartName(part): tuple(map(PartName, before)) for part, before in after.items()}
    deadline = None if deadline_s is None else seconds(deadline_s)
    return ModeSettings(transition=TransitionSettings(waits, deadline, on_failure))


def ordered_model(
    after: Mapping[str, Sequence[str]],
    on_failure: OnFailure = OnFailure.CONTINUE,
    deadline_s: float | None = None,
    parts: Sequence[str] = NODES,
) -> SmhModel:
    """Return a system of nodes with two modes, both of which are entered in this order."""
    modes = {DEFAULT_MODE: {"speed": 0.1}, FAST: {"speed": 0.9}}
    names = tuple(map(PartName, parts))
    return SmhModel(
        {name: NodeModel(name, modes) for name in names},
        {ROBOT: SystemModel(ROBOT, {m: {name: active(m) for name in names} for m in modes})},
        {ROBOT: {EVERY_MODE: settings(after, on_failure, deadline_s)}},
    )
