"""The block `devices` of a robot file: the computers of a robot besides its supervisor."""

from collections.abc import Mapping
from typing import Annotated, TypeAlias

from pydantic import Field, model_validator

from domain.computers import ComputerName
from domain.devices.owned_facts import is_own
from domain.devices.settings import DeviceSettings, OfflineSettings
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName, StateAndMode, part_name
from domain.timebase import seconds
from service.files.robot_settings import SignalsBlock
from service.files.settings_block import Seconds, SettingsBlock

MAX_DEVICES = 100

DeviceName: TypeAlias = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_-]{0,62}$")]
_PartOfModel: TypeAlias = Annotated[str, Field(min_length=1, max_length=256)]
_SignalName: TypeAlias = Annotated[str, Field(min_length=1, max_length=65)]

VEHICLE_IS_ELSEWHERE = (
    "vehicle, tasks and holds are the supervisor's; run the supervisor on the computer that drives"
)


class OfflineBlock(SettingsBlock):
    """What a device does on its own while its supervisor cannot be heard, and nothing else.

    It never activates anything while the emergency stop is engaged, and does nothing before it was
    connected since its start.
    """

    after_s: Seconds = 2.0
    """How long after the last echo of the supervisor, in seconds; at least `lost_s` of `link`."""
    target: dict[_PartOfModel, str] = Field(default_factory=dict)
    """What is requested then, by part: `inactive`, or `active.SLOW`. The parts must be all the
    device's own. Default: they stay as they are."""
    reactions: bool = False
    """Whether its reactions act meanwhile: those whose conditions and targets are all its own."""


class DeviceBlock(SettingsBlock):
    """One device. It runs `pilothouse device NAME` with the same model and robot file."""

    parts: Annotated[list[_PartOfModel], Field(min_length=1)]
    """Nodes that it alone commands; a system stands for all nodes below it."""
    signals: list[_SignalName] = Field(default_factory=list)
    """Signals that are read there. Those whose `part` is its own are read there anyway."""
    offline: OfflineBlock = OfflineBlock()
    """What it does while it is cut off. Default: nothing changes."""

    @model_validator(mode="before")
    @classmethod
    def _has_no_vehicle(cls, keys: object) -> object:
        if isinstance(keys, Mapping) and not keys.keys().isdisjoint({"vehicle", "driving"}):
            raise ValueError(VEHICLE_IS_ELSEWHERE)
        return keys


DevicesBlock: TypeAlias = Annotated[dict[DeviceName, DeviceBlock], Field(max_length=MAX_DEVICES)]


def device_settings(
    devices: Mapping[str, DeviceBlock], signals: SignalsBlock, model: SmhModel
) -> tuple[DeviceSettings, ...]:
    """Return what each device owns and does, for the core.

    Args:
        devices: Checked by `faults_of_devices`.
        signals: All signals of the robot.
        model: Its parts.
    """
    return tuple(
        DeviceSettings(
            ComputerName(name),
            nodes_of(device, model),
            signals_of(device, signals, model),
            _offline(device.offline),
        )
        for name, device in devices.items()
    )


def nodes_of(device: DeviceBlock, model: SmhModel) -> tuple[PartName, ...]:
    """Return the nodes of a device in the order of the model; what is no part is left out."""
    named = (part_name(name) for name in device.parts)
    own = {node for part in named if part in model for node in model.nodes_below(part)}
    return tuple(node for node in model.nodes if node in own)


def signals_of(device: DeviceBlock, signals: SignalsBlock, model: SmhModel) -> tuple[str, ...]:
    """Return the signals that a device reads: those that it names, and those of its parts."""
    nodes = nodes_of(device, model)
    own = [name.lstrip("/") for name in device.signals]
    for name, signal in signals.further.items():
        part = None if signal.part is None else part_name(signal.part)
        if signal.of is None and part is not None and part in model and is_own(part, nodes, model):
            own.append(name)
    return tuple(dict.fromkeys(own))


def _offline(block: OfflineBlock) -> OfflineSettings:
    targets = {part_name(part): StateAndMode.parse(text) for part, text in block.target.items()}
    return OfflineSettings(seconds(block.after_s), targets, block.reactions)
