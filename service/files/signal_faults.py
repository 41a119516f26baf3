"""What is wrong with declared signals on the robot of a certain model."""

from collections.abc import Iterator
from typing import TypeAlias

from domain.errors import near_match
from domain.health.built_in_errors import OF_NODES
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName
from service.files.robot_settings import SignalsBlock

Fault: TypeAlias = tuple[tuple[str, ...], str, str]
"""The keys that lead to it below `signals`, its code and its words."""


def faults_of_signals(signals: SignalsBlock, model: SmhModel) -> Iterator[Fault]:
    """Yield what is wrong; each signal is valid by itself."""
    for name, signal in signals.further.items():
        if signal.part is None:
            continue
        part = PartName(signal.part.lstrip("/"))
        if part not in model:
            near = near_match(part, tuple(map(str, model.parts)))
            hint = f"; did you mean {near}?" if near else ""
            yield (name, "part"), "UNKNOWN_PART", f"there is no part {part!r}{hint}"
        elif signal.error in OF_NODES:
            message = f"{signal.error} is an error that Pilothouse itself raises"
            yield (name, "error"), "DUPLICATE_ERROR", message
        elif signal.error in model.errors.get(part, {}):
            message = f"{part} has an error {signal.error} in the model file already"
            yield (name, "error"), "DUPLICATE_ERROR", message
