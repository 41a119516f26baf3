"""What one computer of a robot runs of its model and its settings."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Self

from pydantic import PrivateAttr

from domain.computers import ComputerName
from domain.devices.own_signals import readable_signals, signals_of_device
from domain.devices.owned_facts import is_own
from domain.devices.settings import DeviceSettings, LeadSettings
from domain.devices.sub_model import LeftOut, sub_model
from domain.errors import UnknownDeviceError
from domain.health.signals import SignalSettings
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName, part_name
from service.files.includes import INCLUDE
from service.files.robot_file import RobotSettings
from service.files.ros2_block import error_named
from service.files.source_block import MISSED_PERIODS


class SettingsOfDevice(RobotSettings):
    """The settings of a robot as one of its devices has them."""

    _own: DeviceSettings = PrivateAttr()
    _parts: Collection[PartName] = PrivateAttr(default=())

    def of_device(self, own: DeviceSettings, parts: Collection[PartName]) -> Self:
        """Return these settings as those of a device; until then it is not known whose they are."""
        self._own, self._parts = own, parts
        return self

    def to_signal_settings(self) -> tuple[SignalSettings, ...]:
        """Return the signals that are read at the device, and the stop."""
        return signals_of_device(super().to_signal_settings(), self._own.signals, self._parts)

    def to_lead_settings(self) -> LeadSettings:
        """Return what the device must know to judge whose word counts."""
        supervisor_at = next(iter(self.link.connect), "")
        return LeadSettings(self._own.name, self._own.offline, self.link.lost, supervisor_at)


@dataclass(frozen=True, slots=True)
class ComputerShare:
    """The share of one computer; that of the only one is everything."""

    model: SmhModel
    """What its core supervises."""
    robot: RobotSettings
    """Settings of its core."""
    local_model: SmhModel
    """The nodes that its own backend reaches."""
    local_robot: RobotSettings
    """Settings of its own backend and sources."""
    read_elsewhere: frozenset[str] = frozenset()
    """Signals that are read at another computer, and not to be mocked here."""
    left_out: tuple[LeftOut, ...] = ()
    """What a device does not do of what the model says about its parts."""


def share_of(model: SmhModel, robot: RobotSettings) -> ComputerShare:
    """Return the share of the computer that the settings are read for.

    Args:
        model: Of the whole robot.
        robot: Its settings; `device` says which computer this is, by default the supervisor, or the
            only one.

    Raises:
        UnknownDeviceError: There is no such device.
    """
    if robot.device is not None:
        return _share_of_device(model, robot, ComputerName(robot.device))
    if robot.devices:
        return _share_of_supervisor(model, robot)
    return ComputerShare(model, robot, model, robot)


def reactions_of_devices(model: SmhModel, robot: RobotSettings) -> dict[str, ComputerName]:
    """Return by name of a reaction the device that decides about it, since all of it is there."""
    if not (robot.devices and model.reactions):
        return {}
    signals = robot.to_signal_settings()
    return {
        name: device.name
        for device in robot.to_device_settings(model)
        for declared in sub_model(
            model, device.nodes, readable_signals(signals, device.signals)
        ).model.reactions.values()
        for name in declared
    }


def left_to_supervisor(
    model: SmhModel, robot: RobotSettings
) -> dict[ComputerName, tuple[LeftOut, ...]]:
    """Return by device what it does not do of what the model says about its parts, if anything."""
    signals = robot.to_signal_settings()
    shares = {
        device.name: sub_model(model, device.nodes, readable_signals(signals, device.signals))
        for device in robot.to_device_settings(model)
    }
    return {name: share.left_out for name, share in shares.items() if share.left_out}


def _share_of_device(model: SmhModel, robot: RobotSettings, name: ComputerName) -> ComputerShare:
    devices = {device.name: device for device in robot.to_device_settings(model)}
    if name not in devices:
        raise UnknownDeviceError("device", name, tuple(devices))
    device, signals = devices[name], robot.to_signal_settings()
    own = sub_model(model, device.nodes, readable_signals(signals, device.signals))
    parts = frozenset(own.model.parts)
    data = _without_robot(_restricted(robot, own.model.nodes, device.signals), parts)
    settings = SettingsOfDevice.model_validate(data).of_device(device, parts)
    elsewhere = {signal.spec.name for signal in signals} - set(device.signals)
    return ComputerShare(
        own.model, settings, own.model, settings, frozenset(elsewhere), own.left_out
    )


def _share_of_supervisor(model: SmhModel, robot: RobotSettings) -> ComputerShare:
    """Return all of the robot; its backend reaches the nodes that no device owns."""
    devices = robot.to_device_settings(model)
    owned = {node for device in devices for node in device.nodes}
    elsewhere = frozenset(signal for device in devices for signal in device.signals)
    nodes = {name: node for name, node in model.nodes.items() if name not in owned}
    read = {signal.spec.name for signal in robot.to_signal_settings()} - elsewhere
    data = _restricted(robot, model.nodes, read)
    if robot.ros2.diagnostics is not None:
        _cut_diagnostics(data["ros2"], _parts_of_supervisor(model, devices))
    core = RobotSettings.model_validate(data)
    local = core.model_copy(
        update={"nodes": {name: own for name, own in core.nodes.items() if name in nodes}}
    )
    return ComputerShare(model, core, SmhModel(nodes, {}), local, elsewhere)


def _parts_of_supervisor(model: SmhModel, devices: Iterable[DeviceSettings]) -> frozenset[PartName]:
    """Return the parts that no device owns alone; their errors are reported at the supervisor."""
    theirs = {part for each in devices for part in model.parts if is_own(part, each.nodes, model)}
    return frozenset(model.parts) - theirs


def _restricted(
    robot: RobotSettings, nodes: Collection[PartName], read: Collection[str]
) -> dict[str, Any]:
    """Return the settings of one computer as plain values.

    Args:
        robot: Settings of the whole robot.
        nodes: Those that its core supervises.
        read: Signals that it reads.
    """
    data = robot.model_dump(exclude_unset=True, by_alias=True)
    data.pop(INCLUDE, None)
    periods = {name: source.period_s for name, source in robot.signals.sources.items()}
    general = robot.signals.stale_after_s
    signals = data.get("signals", {})
    for name, period_s in periods.items():
        if name not in read:
            # It goes stale as it does where it is read.
            usual = {} if general is not None else {"stale_after_s": MISSED_PERIODS * period_s}
            rest = {key: value for key, value in signals[name].items() if key != "source"}
            signals[name] = {**usual, **rest}
    own = data.get("nodes", {})
    data["nodes"] = {name: block for name, block in own.items() if name in nodes}
    ros2 = data.get("ros2", {})
    for key in {"signals", "statistics"} & ros2.keys():
        ros2[key] = {name: block for name, block in ros2[key].items() if name in read}
    return data


def _without_robot(data: dict[str, Any], parts: Collection[PartName]) -> dict[str, Any]:
    """Return the settings of a device without what is the supervisor's: vehicle and targets."""
    data.pop("start_task", None)
    data.pop("tasks", None)
    ros2 = data.get("ros2", {})
    ros2.pop("odometry", None)
    ros2.pop("command", None)
    _cut_diagnostics(ros2, parts)
    for node in data["nodes"].values():
        node.pop("on_return", None)  # Who asked for a target restores it.
    return data


def _cut_diagnostics(ros2: dict[str, Any], parts: Collection[PartName]) -> None:
    diagnostics: Mapping[str, Any] | None = ros2.get("diagnostics")
    if diagnostics is None:
        return
    errors = {
        status: name
        for status, name in diagnostics["errors"].items()
        if part_name(error_named(name)[0]) in parts
    }
    if errors:
        ros2["diagnostics"] = {**diagnostics, "errors": errors}
    else:
        del ros2["diagnostics"]
