"""Robot files: the settings of a robot besides its model, as YAML.

The keys are documented in docs/reference/robot-file.schema.json.
"""

import json
from collections.abc import Iterator
from collections.abc import Mapping as AnyMapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Field, ValidationError, field_validator

from domain.changes.settings import ChangeSettings
from domain.controller import ControllerSettings
from domain.devices.settings import DeviceSettings, LeadSettings, ownership_text
from domain.errors import InvalidValueError, PilothouseError, UnknownPartError, near_match
from domain.findings import Finding
from domain.health.checkpoints import CheckpointSettings
from domain.health.signals import ESTOP_SIGNAL, SignalSettings
from domain.navigation import NavigationSettings
from domain.parts.system_model import SmhModel
from domain.processes.settings import ProcessSettings
from domain.reactions.settings import RuleSettings
from domain.state_and_mode import PartName
from domain.tasks.settings import TaskSettings
from domain.timebase import seconds
from domain.vehicle import VehicleLimits
from service.files.device_faults import faults_of_devices
from service.files.devices_block import DeviceName, DevicesBlock, device_settings
from service.files.driving_block import DrivingBlock, StartTaskBlock, TasksBlock
from service.files.includes import (
    INCLUDE,
    MAX_INCLUDED,
    InvalidIncludeError,
    Keys,
    Merged,
    with_includes,
)
from service.files.limits_block import LimitsBlock
from service.files.link_block import LinkBlock
from service.files.monitor_templates import Parameter, TemplateName
from service.files.parameter_file import scalar_value
from service.files.robot_settings import ChangesBlock, NodeBlock, RulesBlock, SignalsBlock
from service.files.ros2_block import Ros2Block
from service.files.settings_block import SettingsBlock, bare_names
from service.files.signal_faults import faults_of_signals
from service.files.vehicle_block import VehicleBlock
from service.files.yaml_tree import Mapping, Node, Scalar, Sequence, finding_at, in_order, read_tree

Included: TypeAlias = (
    TemplateName
    | Annotated[dict[TemplateName, dict[str, Parameter]], Field(min_length=1, max_length=1)]
)
"""A template, and its parameters if there are any."""

Fault: TypeAlias = tuple[Keys, str, str]
"""The keys that lead to a fault, its code and its message."""

_WORDS = {"extra_forbidden": "unknown key", "model_type": "expected keys below"}


class InvalidRobotFileError(PilothouseError):
    """An invalid robot file; `findings` hold all errors."""

    code = "INVALID_ROBOT_FILE"

    def __init__(self, findings: list[Finding]) -> None:
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        super().__init__(f"the robot file is invalid: {findings[0].message}{more}")
        self.findings = tuple(findings)


class RobotSettings(SettingsBlock):
    """Settings of a robot. Omitted keys keep their default."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_.-]{0,63}$")] | None = None
    """Name of the robot; what survives a restart is kept under it. Default: the name of the model
    file, without its ending. Without effect in simulations."""
    backend: Literal["simulated", "ros2"] = "simulated"
    """Backend through which nodes are reached. Without effect in simulations."""
    mock: bool | None = None
    """Whether to publish mock signals. Default: as `pilothouse serve` is started; with simulated
    nodes they are published."""
    include: Annotated[list[Included], Field(max_length=MAX_INCLUDED)] = Field(default_factory=list)
    """Templates of signals and monitors, each by its name, or by its name with parameters below it.
    What the file itself says about a signal goes before what a template says."""
    signals: SignalsBlock = SignalsBlock()
    """Error conditions of signals."""
    nodes: dict[str, NodeBlock] = Field(default_factory=dict)
    """Settings of nodes that differ from the default, by name."""
    changes: ChangesBlock = ChangesBlock()
    """Deadlines of changes."""
    rules: RulesBlock = RulesBlock()
    """When rules of the model act."""
    vehicle: VehicleBlock = VehicleBlock()
    """Limits of the vehicle, and dynamics of a simulated one."""
    driving: DrivingBlock = DrivingBlock()
    """When a task may begin, how fast it is driven, and when it is aborted."""
    limits: LimitsBlock = LimitsBlock()
    """Limits on what clients may request."""
    ros2: Ros2Block = Ros2Block()
    """ROS 2 topics of the robot. Without effect for a simulated robot, but for `messages`."""
    device: DeviceName | None = None
    """The device that this file is read for. `pilothouse device NAME` sets it in its record, so
    that the record can be replayed; leave it out of a file that all computers share."""
    devices: DevicesBlock = Field(default_factory=dict)
    """Further computers of the robot, by name, each with the parts that it alone commands. Default:
    there are none. Without effect in simulations."""
    link: LinkBlock = LinkBlock()
    """How these computers reach each other. Without effect in simulations."""
    tasks: TasksBlock | None = None
    """Tasks that clients begin by the name of a waypoint file. Default: they cannot. Without effect
    in simulations, which do not read files."""
    start_task: StartTaskBlock | None = None
    """A task that is submitted when the service starts. Not allowed in simulations, which do not
    read files."""

    @field_validator("nodes")
    @classmethod
    def _without_leading_slashes(cls, nodes: dict[str, NodeBlock]) -> dict[str, NodeBlock]:
        return bare_names(nodes)

    def to_signal_settings(self) -> tuple[SignalSettings, ...]:
        """Return all signals: the five default ones with these settings, then the declared ones.

        Raises:
            InvalidValueError: A threshold is out of range, or on the wrong side of the other one;
                `pointer` is `<signal>/<setting>`.
        """
        return self.signals.to_domain()

    def to_change_settings(self) -> ChangeSettings:
        """Return the deadlines of changes, and the nodes to restore."""
        return ChangeSettings(
            restored_nodes=frozenset(
                PartName(name) for name, node in self.nodes.items() if node.on_return == "restore"
            ),
            transition_deadline=seconds(self.changes.transition_deadline_s),
            parameters_deadline=seconds(self.changes.parameters_deadline_s),
        )

    def to_rule_settings(self) -> RuleSettings:
        """Return when rules act."""
        return self.rules.to_domain()

    def to_checkpoint_settings(self) -> dict[PartName, CheckpointSettings]:
        """Return what is supervised of the checkpoints of nodes."""
        return {
            PartName(name): node.checkpoints.to_domain()
            for name, node in self.nodes.items()
            if node.checkpoints is not None
        }

    def to_process_settings(self) -> dict[PartName, ProcessSettings]:
        """Return when the processes of nodes are started again."""
        return {
            PartName(name): node.process.to_domain()
            for name, node in self.nodes.items()
            if node.process is not None
        }

    def to_device_settings(self, model: SmhModel) -> tuple[DeviceSettings, ...]:
        """Return the devices, and which nodes and signals of the model each of them owns."""
        return device_settings(self.devices, self.signals, model)

    def ownership_text(self, model: SmhModel) -> str:
        """Return what all computers must agree on besides the model, as one canonical text."""
        return ownership_text(self.to_device_settings(model), self.link.late, self.link.lost)

    def to_lead_settings(self) -> LeadSettings | None:
        """Return what a device must know to judge whose word counts; None: this is no device."""
        return None

    def to_vehicle_limits(self) -> VehicleLimits:
        """Return the limits of the vehicle."""
        return self.vehicle.to_limits()

    def to_task_settings(self) -> TaskSettings:
        """Return the settings of tasks."""
        return self.driving.to_task_settings()

    def to_navigation_settings(self) -> NavigationSettings:
        """Return the settings of navigation."""
        return self.driving.to_navigation_settings()

    def to_controller_settings(self) -> ControllerSettings | None:
        """Return the deadlines of the external controller; None: the trackers on board drive."""
        navigation = self.ros2.navigation
        if navigation is None or self.backend != "ros2" or self.device is not None:
            return None
        return navigation.to_settings()


def read_robot_file(text: str, model: SmhModel) -> RobotSettings:
    """Read settings from YAML; scalars are read as in a model.

    Raises:
        InvalidRobotFileError: A key or value is wrong, or names a node that is not in the model.
    """
    tree = read_tree(text)
    findings = list(tree.findings)
    root = tree.documents[0] if tree.documents else Mapping(1, 1)
    if len(tree.documents) > 1 and tree.documents[1] is not None:
        message = "a robot file must be a single YAML document"
        findings.append(finding_at(tree.documents[1], "INVALID_VALUE", message))
    settings = None
    if root is not None and not findings:
        data = _plain(root, findings)
        if not findings:
            settings = _settings(root, data, model, findings)
    if settings is None or findings:
        raise InvalidRobotFileError(in_order(text, findings))
    return settings


def written_out(text: str) -> str:
    """Return a valid robot file with its templates in their place, as a log keeps it.

    It means the same when a later release has other templates. It has no environment of a process,
    which may hold secrets.
    """
    data = _plain_text(text)
    return _written(data) if data.get(INCLUDE) or _has_environment(data) else text


def written_with_backend(text: str, backend: str) -> str:
    """Return a valid robot file as the log keeps it where the command named the backend."""
    return _written({**_plain_text(text), "backend": backend})


def written_for_device(text: str, device: str) -> str:
    """Return a valid robot file as the log of a device keeps it: it says which device that is."""
    return _written({**_plain_text(text), "device": device})


def _plain_text(text: str) -> dict[str, Any]:
    tree = read_tree(text)
    data = _plain(tree.documents[0], []) if tree.documents else None
    return data if isinstance(data, dict) else {}


def _written(data: AnyMapping[str, Any]) -> str:
    merged = {key: value for key, value in with_includes(data).data.items() if key != INCLUDE}
    if _has_environment(data):
        merged["nodes"] = {name: _without_environment(node) for name, node in _nodes(data)}
    return json.dumps(merged, ensure_ascii=False, indent=2) + "\n"


def _nodes(data: AnyMapping[str, Any]) -> Iterator[tuple[str, AnyMapping[str, Any]]]:
    yield from data.get("nodes", {}).items()


def _has_environment(data: AnyMapping[str, Any]) -> bool:
    return any("environment" in node.get("process", {}) for _, node in _nodes(data))


def _without_environment(node: AnyMapping[str, Any]) -> AnyMapping[str, Any]:
    if "process" not in node:
        return node
    process = {key: value for key, value in node["process"].items() if key != "environment"}
    return {**node, "process": process}


def robot_settings_of(data: AnyMapping[str, object], model: SmhModel) -> RobotSettings:
    """Return settings that were sent as JSON, for a simulation; they must not name files.

    Raises:
        InvalidValueError: A key or value is wrong; `pointer` leads to it.
    """
    if "start_task" in data:
        raise InvalidValueError(
            "start_task names a file; it is allowed only in a robot file", "/start_task"
        )
    try:
        merged = with_includes(data)
    except InvalidIncludeError as error:
        raise InvalidValueError(error.message, _pointer(*error.keys)) from error
    try:
        settings = RobotSettings.model_validate(merged.data)
    except ValidationError as error:
        fault = error.errors(include_url=False, include_input=False)[0]
        words = _WORDS.get(fault["type"], fault["msg"].removeprefix("Value error, "))
        raise InvalidValueError(words, _pointer(*merged.place_of(fault["loc"]))) from error
    try:
        settings.to_signal_settings()
    except InvalidValueError as error:
        at = ("signals", *error.pointer.split("/"))
        raise InvalidValueError(error.message, _pointer(*merged.place_of(at))) from error
    for name in settings.nodes:
        if name not in model.nodes:
            raise InvalidValueError(_no_node(name, model), _pointer("nodes", name))
    for keys, _, message in _faults(settings, model):
        raise InvalidValueError(message, _pointer(*merged.place_of(keys)))
    # One computer simulates all of it, the trackers on board drive, and whoever sends settings runs
    # no programs here.
    nodes = {
        name: node.model_copy(update={"process": None}) for name, node in settings.nodes.items()
    }
    alone = {"devices": {}, "device": None, "backend": "simulated", "nodes": nodes}
    return settings.model_copy(update=alone)


def _no_node(name: str, model: SmhModel) -> str:
    """Return why the settings of a node are of none: there is none, or it is a system."""
    if name in model.systems:
        return UnknownPartError.of_other_kind(name, "node").message
    near = near_match(name, tuple(model.nodes))
    return f"there is no node {name!r}" + (f"; did you mean {near}?" if near else "")


def _pointer(*keys: int | str) -> str:
    """Return a JSON pointer (RFC 6901); slashes in names are escaped."""
    return "".join(f"/{str(key).replace('~', '~0').replace('/', '~1')}" for key in keys)


def _settings(
    root: Node, data: object, model: SmhModel, findings: list[Finding]
) -> RobotSettings | None:
    """Return the settings, or None and findings."""
    try:
        merged = with_includes(data)
    except InvalidIncludeError as error:
        findings.append(finding_at(_place(root, error.keys), "INVALID_VALUE", error.message))
        return None
    try:
        settings = RobotSettings.model_validate(merged.data)
        settings.to_signal_settings()
    except ValidationError as error:
        findings.extend(
            _complaint(root, merged, fault["loc"], fault["type"], fault["msg"])
            for fault in error.errors(include_url=False, include_input=False)
        )
        return None
    except InvalidValueError as error:
        place = _place(root, merged.place_of(("signals", *error.pointer.split("/"))))
        findings.append(finding_at(place, "INVALID_VALUE", error.message))
        return None
    for name in settings.nodes:
        if name not in model.nodes:
            place = _place(root, ("nodes", name))
            findings.append(finding_at(place, "UNKNOWN_NODE", _no_node(name, model)))
    for keys, code, message in _faults(settings, model):
        findings.append(finding_at(_place(root, merged.place_of(keys)), code, message))
    return settings


def _faults(settings: RobotSettings, model: SmhModel) -> Iterator[Fault]:
    """Yield what is wrong with signals and their topics; each value is valid by itself."""
    for keys, code, message in faults_of_signals(settings.signals, model):
        yield ("signals", *keys), code, message
    kinds = {signal.spec.name: signal.spec.kind for signal in settings.to_signal_settings()}
    for keys, code, message in settings.ros2.faults(kinds, model):
        yield ("ros2", *keys), code, message
    of_devices = faults_of_devices(settings.devices, settings.signals, model, settings.link.lost_s)
    for place, code, message in of_devices:
        yield ("devices", *place), code, message
    if settings.device is not None and settings.device not in settings.devices:
        known = ", ".join(settings.devices) or "none"
        yield (
            ("device",),
            "INVALID_VALUE",
            f"there is no device {settings.device!r}; known: {known}",
        )
    yield from _faults_of_two_sources(settings)


def _faults_of_two_sources(settings: RobotSettings) -> Iterator[Fault]:
    """Yield signals that have a topic beside what else gives their value."""
    further = settings.signals.further
    for key, named in (
        ("signals", settings.ros2.signals),
        ("statistics", settings.ros2.statistics),
    ):
        for name in named:
            monitored = further[name].of if name in further else None
            if monitored is not None:
                message = f"{name} is a monitor: its value follows from {monitored}"
                yield ("ros2", key, name), "INVALID_VALUE", message
            # Several sources of a stop are kept apart; else the newest reading would count.
            elif name in settings.signals.sources and name != ESTOP_SIGNAL:
                message = f"{name} has a source under signals; remove one of them"
                yield ("ros2", key, name), "INVALID_VALUE", message


def _plain(node: Node | None, findings: list[Finding]) -> Any:  # noqa: ANN401  # as in JSON
    """Return a tree as plain values."""
    match node:
        case Scalar():
            value = scalar_value(node)
            if value is None:
                message = "missing value; remove the key"
                findings.append(finding_at(node, "EMPTY_VALUE", message))
            return value
        case Sequence():
            return [_plain(item, findings) for item in node.items]
        case Mapping():
            return {key.text: _plain(value, findings) for key, value in node.entries}
        case None:
            return None


def _complaint(root: Node, merged: Merged, location: Keys, kind: str, message: str) -> Finding:
    where = ".".join(str(key) for key in location)
    words = _WORDS.get(kind, message.removeprefix("Value error, "))
    code = "UNKNOWN_KEY" if kind == "extra_forbidden" else "INVALID_VALUE"
    place = _place(root, merged.place_of(location))
    return finding_at(place, code, f"{where}: {words}" if where else words)


def _place(root: Node, location: Keys) -> Node:
    """Return the last node of the tree on the way to `location` that is in the file."""
    place, tree = root, root
    for step in location:
        if isinstance(tree, Sequence) and isinstance(step, int):
            item = tree.items[step]
            if item is None:
                break
            place = tree = item
            continue
        if not isinstance(tree, Mapping):
            break
        named = str(step).lstrip("/")
        entries = ((key, value) for key, value in tree.entries if key.text.lstrip("/") == named)
        found = next(entries, None)
        if found is None:
            break
        place = found[0]
        if found[1] is None:
            break
        tree = found[1]
    return place
