"""What is wrong with the devices of a robot file; each block is valid by itself."""

from collections.abc import Iterator, Mapping
from typing import TypeAlias

from domain.computers import SUPERVISOR
from domain.devices.own_signals import readable_signals
from domain.devices.owned_facts import is_own
from domain.devices.sub_model import sub_model
from domain.errors import near_match
from domain.lifecycle import LifecycleState
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName, StateAndMode, part_name
from service.files.devices_block import (
    VEHICLE_IS_ELSEWHERE,
    DeviceBlock,
    nodes_of,
    signals_of,
)
from service.files.robot_settings import SignalsBlock

Fault: TypeAlias = tuple[tuple[int | str, ...], str, str]
"""The keys that lead to it below `devices`, its code and its words."""

_OF_THE_VEHICLE = frozenset({"vehicle", "navigation", "task", "tasks"})
_PRIMARY = tuple(str(state) for state in LifecycleState if state.is_primary)


def faults_of_devices(
    devices: Mapping[str, DeviceBlock], signals: SignalsBlock, model: SmhModel, lost_s: float
) -> Iterator[Fault]:
    """Yield what is wrong.

    Args:
        devices: By name.
        signals: All signals of the robot.
        model: Its parts.
        lost_s: After which silence a computer is lost, in seconds.
    """
    for name, device in devices.items():
        yield from _of_name(name, model)
        for keys, code, message in _of_parts(name, device, model):
            yield (name, *keys), code, message
        for keys, code, message in _of_signals(name, device, signals):
            yield (name, *keys), code, message
        of_offline = list(_of_offline(name, device, model, lost_s))
        for keys, code, message in of_offline or _of_guards(name, device, signals, model):
            yield (name, "offline", *keys), code, message
    yield from _owned_twice(devices, model)
    yield from _read_twice(devices, signals, model)


def _of_name(name: str, model: SmhModel) -> Iterator[Fault]:
    if name == SUPERVISOR:
        message = f"{SUPERVISOR} is the name of the computer that supervises the devices"
        yield (name,), "DEVICE_NAME", message
    elif name in model:
        yield (name,), "DEVICE_NAME", f"{name} is a part already: give the device another name"


def _of_parts(name: str, device: DeviceBlock, model: SmhModel) -> Iterator[Fault]:
    for place, text in enumerate(device.parts):
        part = part_name(text)
        if part in model:
            if not model.nodes_below(part):
                yield ("parts", place), "INVALID_VALUE", f"{part} has no nodes"
        elif part in _OF_THE_VEHICLE:
            yield ("parts", place), "VEHICLE_ELSEWHERE", VEHICLE_IS_ELSEWHERE
        else:
            yield ("parts", place), "UNKNOWN_PART", _no_part(part, model)


def _of_signals(name: str, device: DeviceBlock, signals: SignalsBlock) -> Iterator[Fault]:
    known = {settings.spec.name: settings for settings in signals.to_domain()}
    for place, text in enumerate(device.signals):
        signal = text.lstrip("/")
        settings = known.get(signal)
        if settings is None:
            near = near_match(signal, tuple(known))
            hint = f"; did you mean {near}?" if near else ""
            message = f"there is no signal {signal!r}{hint}; declare it under signals"
            yield ("signals", place), "UNKNOWN_SIGNAL", message
        elif settings.monitor is not None:
            message = f"{signal} is a monitor: {name} computes it if it reads {settings.monitor.of}"
            yield ("signals", place), "INVALID_VALUE", message


def _of_offline(name: str, device: DeviceBlock, model: SmhModel, lost_s: float) -> Iterator[Fault]:
    offline = device.offline
    acts = bool(offline.target) or offline.reactions
    if offline.after_s < lost_s and (acts or "after_s" in offline.model_fields_set):
        message = (
            f"{name} is cut off only {lost_s:g} s after the last echo (lost_s of link);"
            f" after_s must not be less"
        )
        yield ("after_s",), "OFFLINE_TOO_SOON", message
    nodes = nodes_of(device, model)
    taken: dict[PartName, PartName] = {}
    for text, target in offline.target.items():
        part, place = part_name(text), ("target", text)
        if part not in model:
            yield place, "UNKNOWN_PART", _no_part(part, model)
            continue
        if not is_own(part, nodes, model):
            yield place, "NOT_OWN", f"{part} is not all {name}'s own: it must not command it alone"
            continue
        for node in model.nodes_below(part):
            other = taken.setdefault(node, part)
            if other != part:
                message = f"{node} has a target already, by {other}"
                yield place, "INVALID_VALUE", message
                break
        yield from ((place, code, message) for code, message in _of_target(part, target, model))


def _of_target(part: PartName, text: str, model: SmhModel) -> Iterator[tuple[str, str]]:
    """Yield why a text is no target of a part."""
    try:
        target = StateAndMode.parse(text)
    except ValueError:
        target = None
    if target is None or not target.state.is_primary:
        near = near_match(text, _PRIMARY)
        hint = f"; did you mean {near}?" if near else ""
        yield "UNKNOWN_STATE", f"{text!r} is none of {', '.join(_PRIMARY)}{hint}"
        return
    named = text.partition(".")[2]
    if named and target.mode is None:
        yield "INVALID_VALUE", f"only active has modes, not {target.state}"
    elif target.mode is not None and target.mode not in model.modes_of(part):
        modes = ", ".join(model.modes_of(part))
        known = f"it has {modes}" if modes else "it has no modes"
        yield "UNKNOWN_MODE", f"{part} has no mode {target.mode!r}; {known}"


def _of_guards(
    name: str, device: DeviceBlock, signals: SignalsBlock, model: SmhModel
) -> Iterator[Fault]:
    """Yield targets with guards that the device cannot judge alone."""
    if not device.offline.target:
        return
    read = readable_signals(signals.to_domain(), signals_of(device, signals, model))
    own = sub_model(model, nodes_of(device, model), read)
    for text, target in device.offline.target.items():
        why = own.unjudged(part_name(text), StateAndMode.parse(target))
        if why is not None:
            yield ("target", text), "NOT_OWN", f"{why}, which {name} does not know when cut off"


def _owned_twice(devices: Mapping[str, DeviceBlock], model: SmhModel) -> Iterator[Fault]:
    """Yield the parts by which a device would own a node that an earlier one owns."""
    owners: dict[PartName, str] = {}
    for name, device in devices.items():
        for place, text in enumerate(device.parts):
            part = part_name(text)
            below = model.nodes_below(part) if part in model else ()
            for node in below:
                owner = owners.setdefault(node, name)
                if owner != name:
                    what = node if node == part else f"{node} of {part}"
                    message = f"{what} is owned by {owner} already"
                    yield (name, "parts", place), "OWNED_TWICE", message
                    break


def _read_twice(
    devices: Mapping[str, DeviceBlock], signals: SignalsBlock, model: SmhModel
) -> Iterator[Fault]:
    """Yield the signals that two devices would read; the earlier one does."""
    readers: dict[str, str] = {}
    for name, device in devices.items():
        named = [signal.lstrip("/") for signal in device.signals]
        for signal in signals_of(device, signals, model):
            reader = readers.setdefault(signal, name)
            if reader != name:
                keys = ("signals", named.index(signal)) if signal in named else ()
                yield (name, *keys), "OWNED_TWICE", f"{signal} is read by {reader} already"


def _no_part(part: PartName, model: SmhModel) -> str:
    near = near_match(part, tuple(map(str, model.parts)))
    return f"there is no part {part!r}" + (f"; did you mean {near}?" if near else "")
