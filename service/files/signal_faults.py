"""What is wrong with declared signals on the robot of a certain model."""

from collections.abc import Iterator
from itertools import chain
from typing import TypeAlias

from domain.errors import near_match
from domain.health.built_in_errors import OF_NODES
from domain.health.monitor_graph import faults_of_monitors
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName
from domain.timebase import to_seconds
from domain.windows.settings import Statistic
from service.files.declared_signal import DeclaredSignal
from service.files.mode_limits_block import DEFAULT, part_and_mode
from service.files.robot_settings import SignalsBlock

Fault: TypeAlias = tuple[tuple[str, ...], str, str]
"""The keys that lead to it below `signals`, its code and its words."""

_OF_THE_NEWEST = frozenset({Statistic.AGE, Statistic.STUCK_FOR})
"""Statistics that need no more than the newest readings."""


def faults_of_signals(signals: SignalsBlock, model: SmhModel) -> Iterator[Fault]:
    """Yield what is wrong; each signal is valid by itself."""
    for name, signal in signals.further.items():
        for keys, code, message in chain(_of_part(signal, model), _of_limits(signal, model)):
            yield (name, *keys), code, message
    for fault in faults_of_monitors(signals.to_domain()):
        yield (fault.signal, fault.key), fault.code, fault.message
    yield from _too_large(signals)


def _of_part(signal: DeclaredSignal, model: SmhModel) -> Iterator[Fault]:
    if signal.part is None:
        return
    part = PartName(signal.part.lstrip("/"))
    if part not in model:
        yield ("part",), "UNKNOWN_PART", _no_part(part, model)
    elif signal.error in OF_NODES:
        message = f"{signal.error} is an error that Pilothouse itself raises"
        yield ("error",), "DUPLICATE_ERROR", message
    elif (own := model.errors.get(part, {}).get(str(signal.error))) is not None and own.says_how:
        message = f"the model file says how {signal.error} of {part} is found already"
        yield ("error",), "DUPLICATE_ERROR", message


def _of_limits(signal: DeclaredSignal, model: SmhModel) -> Iterator[Fault]:
    for key in signal.limits or {}:
        if key == DEFAULT:
            continue
        part, mode = part_and_mode(key)
        if part not in model:
            yield ("limits", key), "UNKNOWN_PART", _no_part(part, model)
        elif mode not in model.modes_of(part):
            modes = ", ".join(model.modes_of(part))
            words = f"it is one of {modes}" if modes else f"{part} has no modes"
            message = f"{part} has no mode {mode!r}; {words}" if mode else f"name a mode: {words}"
            yield ("limits", key), "UNKNOWN_MODE", message


def _too_large(signals: SignalsBlock) -> Iterator[Fault]:
    """Yield windows that hold more readings of a source than can be kept."""
    sources = signals.sources
    for name, signal in signals.further.items():
        monitor = signal.monitor()
        source = None if monitor is None else sources.get(signals.root_of(name))
        if monitor is None or source is None or monitor.window.length is None:
            continue
        readings, most = to_seconds(monitor.window.length) / source.period_s, monitor.window.most
        if readings > most and monitor.window.statistic not in _OF_THE_NEWEST:
            message = f"the window would hold {readings:,.0f} readings; {most:,} are kept"
            yield (name, "window_s"), "WINDOW_TOO_LARGE", message


def _no_part(part: PartName, model: SmhModel) -> str:
    near = near_match(part, tuple(map(str, model.parts)))
    return f"there is no part {part!r}" + (f"; did you mean {near}?" if near else "")
