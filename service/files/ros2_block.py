"""Settings of a robot in ROS 2: topics of its signals, odometry and commands."""

import re
from collections.abc import Iterator, Mapping
from typing import Annotated, Literal, Self, TypeAlias, TypeVar

from pydantic import AfterValidator, Field, field_validator, model_validator

from domain.controller import ControllerSettings
from domain.health.signals import SignalKind
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName
from domain.timebase import seconds
from service.files.settings_block import Number, SettingsBlock, bare_names

NAV_SAT_FIX = "sensor_msgs/msg/NavSatFix"
"""The only type from which a signal is computed if no field is given."""

StatusName: TypeAlias = Annotated[str, Field(min_length=1, max_length=256)]
ReportedError: TypeAlias = Annotated[str, Field(pattern=r"^[^.].*\.[A-Z][A-Z0-9_]{0,63}$")]
BlockT = TypeVar("BlockT")
Fault: TypeAlias = tuple[tuple[str, ...], str, str]
"""The keys that lead to a fault, its code and its message."""

_TOPIC = r"^(/[A-Za-z_][A-Za-z0-9_]*)+$"
_TYPE = r"^[a-z][a-z0-9_]*/msg/[A-Z][A-Za-z0-9]*$"
_FIELD = r"^[a-z][a-z0-9_]*(\.([a-z][a-z0-9_]*|[0-9]+))*$"
_LONGEST = 247
"""Longest topic name in ROS 2: 255 minus 8 for the prefix of the middleware."""
_USUAL_FIELDS = {
    "sensor_msgs/msg/BatteryState": "percentage",
    "sensor_msgs/msg/Temperature": "temperature",
}
_PLAIN_TYPES = re.compile(r"std_msgs/msg/(Bool|String|Float(32|64)|U?Int(8|16|32|64))")


def topic_name(name: str) -> str:
    """Return a full topic name.

    Raises:
        ValueError: It is none.
    """
    if len(name) > _LONGEST or not re.fullmatch(_TOPIC, name):
        raise ValueError(
            f"invalid topic name {name!r:.60}; give the full name, such as /battery_state"
        )
    return name


def _type(name: str) -> str:
    if len(name) > _LONGEST or not re.fullmatch(_TYPE, name):
        raise ValueError(
            f"invalid message type {name!r:.60}; expected a type such as std_msgs/msg/Bool"
        )
    return name


def _field(path: str) -> str:
    if len(path) > _LONGEST or not re.fullmatch(_FIELD, path):
        raise ValueError(
            f"invalid field {path!r:.60}; expected a path such as data or position_covariance.0"
        )
    return path


TopicName: TypeAlias = Annotated[
    str, AfterValidator(topic_name), Field(json_schema_extra={"pattern": _TOPIC})
]
MessageType: TypeAlias = Annotated[
    str, AfterValidator(_type), Field(json_schema_extra={"pattern": _TYPE})
]
FieldPath: TypeAlias = Annotated[
    str, AfterValidator(_field), Field(json_schema_extra={"pattern": _FIELD})
]
Deadline: TypeAlias = Annotated[float, Field(ge=0.1, le=60, allow_inf_nan=False)]
Tolerance: TypeAlias = Annotated[float, Field(gt=0, le=100, allow_inf_nan=False)]
ActionType: TypeAlias = Literal[
    "pilothouse_msgs/action/NavigateWaypoints", "nav2_msgs/action/FollowPath"
]
Window: TypeAlias = Annotated[float, Field(gt=0, le=60, allow_inf_nan=False)]
CommandType: TypeAlias = Literal[
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/TwistStamped",
    "ackermann_msgs/msg/AckermannDrive",
    "ackermann_msgs/msg/AckermannDriveStamped",
]


class SignalTopicBlock(SettingsBlock):
    """Topic that a signal is read from.

    Without `field`, a NavSatFix gives the position accuracy in mm, computed from its covariance.
    """

    topic: TopicName
    """Full name of the topic."""
    type: MessageType
    """Message type of the topic."""
    field: FieldPath | None = None
    """Path of the value in the message: fields separated by dots, numbers index lists. Default: the
    value of a BatteryState, a Temperature or a plain std_msgs message."""
    scale: Number = 1.0
    """Factor for a number, such as 0.01 for a battery in percent."""
    offset: Number = 0.0
    """Added to a number after scaling."""
    invert: bool = False
    """Whether to invert a boolean, as for a topic that tells that driving is enabled."""

    @property
    def path(self) -> tuple[str | int, ...] | None:
        """Return the path into a message: fields and list indices; None: the value is computed."""
        field = self.field or self._usual_field
        if field is None:
            return None
        return tuple(int(step) if step.isdigit() else step for step in field.split("."))

    @property
    def _usual_field(self) -> str | None:
        return "data" if _PLAIN_TYPES.fullmatch(self.type) else _USUAL_FIELDS.get(self.type)

    @model_validator(mode="after")
    def _has_a_value(self) -> Self:
        if self.path is None and self.type != NAV_SAT_FIX:
            raise ValueError(f"{self.type} has no default field; set field")
        return self


class StatisticBlock(SettingsBlock):
    """Statistic of a topic that a signal is read from; of the messages, only the stamp is read."""

    topic: TopicName
    """Full name of the topic."""
    type: MessageType
    """Message type of the topic."""
    statistic: Literal["rate", "gap", "age"]
    """`rate`: messages per second; `gap`: the longest time without a message, in s, the one to now
    included; `age`: time since the stamp in the header of the newest message, in s, by the clocks
    of both computers."""
    window_s: Window | None = None
    """Time over which rate and gap are measured, in s. Default: 5."""

    @model_validator(mode="after")
    def _has_a_window_only_if_it_needs_one(self) -> Self:
        if self.statistic == "age" and self.window_s is not None:
            raise ValueError("window_s is for rate and gap only; an age is that of one message")
        return self


class DiagnosticsBlock(SettingsBlock):
    """Errors of parts that others report by `diagnostic_msgs/msg/DiagnosticArray`."""

    topic: TopicName = "/diagnostics"
    """Full name of the topic."""
    errors: Annotated[dict[StatusName, ReportedError], Field(min_length=1)]
    """By name of a status, such as `lidar_driver: Connection`, the error that it reports, such as
    `lidar.LINK`; the model file declares it for its part, with neither `when` nor `caused_by`. It
    is on while one of its statuses has another level than OK."""


class OdometryBlock(SettingsBlock):
    """Topic of the vehicle's odometry."""

    topic: TopicName
    """Full name of a topic of type nav_msgs/msg/Odometry, for the centre of the rear axle, in the
    frame of the waypoints."""


class CommandBlock(SettingsBlock):
    """Topic of the drive commands to the vehicle."""

    topic: TopicName
    """Full name of the topic."""
    type: CommandType
    """Message type that the vehicle subscribes to. A Twist has no steering angle and cannot turn
    the wheels of a vehicle at standstill."""


class NavigationBlock(SettingsBlock):
    """External controller that follows the paths of tasks, an action server."""

    action: TopicName
    """Full name of the action, such as /navigate_waypoints."""
    type: ActionType = "pilothouse_msgs/action/NavigateWaypoints"
    """Type of the action. FollowPath of Nav2 carries no speed: it drives at its own."""
    accepted_within_s: Deadline = 1.0
    """Time in which a goal has to be accepted or rejected, in s."""
    silent_for_s: Deadline = 1.0
    """Time without feedback, in s, after which the goal is taken back. `pilothouse tracker` ends
    its goal after a silence of `/system_state` for as long."""
    taken_back_within_s: Deadline = 1.0
    """Time in which the end of a goal that was taken back has to be confirmed, in s, besides the
    time to stop at `driving.braking_mps2`."""
    stands_within_s: Deadline = 3.0
    """Time in which the vehicle has to stand after the controller said that it arrived, in s."""
    end_tolerance_m: Tolerance = 0.5
    """Largest distance of the vehicle from the last waypoint, in m, when it arrived."""
    claim_tolerance_m: Tolerance = 5.0
    """How far ahead of the vehicle, in m, a waypoint may be that is said to be passed."""

    def to_settings(self) -> ControllerSettings:
        """Return the settings for the navigation."""
        return ControllerSettings(
            self.action,
            seconds(self.accepted_within_s),
            seconds(self.silent_for_s),
            seconds(self.taken_back_within_s),
            seconds(self.stands_within_s),
            self.end_tolerance_m,
            self.claim_tolerance_m,
        )


class Ros2Block(SettingsBlock):
    """ROS 2 topics of the robot."""

    messages: Literal["pilothouse_msgs", "gem_state_msgs"] = "pilothouse_msgs"
    """Package of the messages for signals and the state of the robot. `gem_state_msgs` has the same
    fields under the names of smart_polaris; it has to be installed. Also in effect for rosbridge
    clients of a simulated robot, who may name either."""
    signals: dict[str, SignalTopicBlock] = Field(default_factory=dict)
    """Topics of signals by name of the signal: the five default ones and the declared ones."""
    statistics: dict[str, StatisticBlock] = Field(default_factory=dict)
    """Statistics of topics by name of the declared signal that has their value."""
    diagnostics: DiagnosticsBlock | None = None
    """Errors of parts that others report on a topic. Without it none are taken from there."""
    odometry: OdometryBlock | None = None
    """Topic of the vehicle's odometry. Without it the pose is unknown and no task runs."""
    command: CommandBlock | None = None
    """Topic of the drive commands. Without it no commands are published."""
    navigation: NavigationBlock | None = None
    """External controller that follows the paths of tasks; it commands the vehicle itself, and
    Pilothouse only while the vehicle must stop. Without it the trackers on board drive."""

    @field_validator("signals", "statistics")
    @classmethod
    def _without_leading_slashes(cls, named: dict[str, BlockT]) -> dict[str, BlockT]:
        return bare_names(named)

    def faults(self, kinds: Mapping[str, SignalKind], model: SmhModel) -> Iterator[Fault]:
        """Yield what does not match the signals and the model.

        Args:
            kinds: Kind of each signal by name.
            model: Its parts, and the errors that they declare.
        """
        yield from self._faults_of_types()
        yield from self._faults_of_signals(kinds)
        yield from self._faults_of_diagnostics(model)
        for name in self.statistics:
            place = ("statistics", name)
            if name in self.signals:
                message = f"{name} has a topic under ros2.signals already"
                yield place, "INVALID_VALUE", message
            elif name not in kinds:
                yield place, "UNKNOWN_SIGNAL", _undeclared(name)
            elif kinds[name] is not SignalKind.NUMBER:
                yield place, "INVALID_VALUE", f"a statistic is a number; {name} is not"

    def _faults_of_diagnostics(self, model: SmhModel) -> Iterator[Fault]:
        """Yield errors that cannot be reported: the model has none such, or they are detected."""
        for status, name in (self.diagnostics.errors if self.diagnostics else {}).items():
            place = ("diagnostics", "errors", status)
            part, error = error_named(name)
            if part not in model:
                yield place, "UNKNOWN_PART", f"there is no part {part!r} that has {error}"
                continue
            declared = model.errors.get(part, {}).get(error)
            if declared is None:
                message = f"{part} declares no error {error} in the model file"
                yield place, "UNKNOWN_ERROR", message
            elif declared.when is not None or declared.caused_by:
                message = f"{name} is found by other means, so nobody can report it"
                yield place, "INVALID_VALUE", message

    def _faults_of_types(self) -> Iterator[Fault]:
        """Yield topics that are said to have several types."""
        types: dict[str, str] = {}
        for key, blocks in (("signals", self.signals), ("statistics", self.statistics)):
            for name, block in blocks.items():
                if types.setdefault(block.topic, block.type) != block.type:
                    message = f"{block.topic} has type {types[block.topic]} for another signal"
                    yield (key, name, "type"), "INVALID_VALUE", message

    def _faults_of_signals(self, kinds: Mapping[str, SignalKind]) -> Iterator[Fault]:
        for name, block in self.signals.items():
            place = ("signals", name)
            kind = kinds.get(name)
            if kind is None:
                yield place, "UNKNOWN_SIGNAL", _undeclared(name)
                continue
            for key in sorted({"scale", "offset"} & block.model_fields_set):
                if kind is not SignalKind.NUMBER:
                    message = f"{key} is for numbers only; {name} is not a number"
                    yield (*place, key), "INVALID_VALUE", message
            if "invert" in block.model_fields_set and kind is not SignalKind.BOOLEAN:
                message = f"invert is for booleans only; {name} is not a boolean"
                yield (*place, "invert"), "INVALID_VALUE", message


def error_named(name: str) -> tuple[PartName, str]:
    """Return the part and the error of a name such as `lidar.LINK`."""
    part, _, error = name.lstrip("/").rpartition(".")
    return PartName(part), error


def _undeclared(name: str) -> str:
    return f"there is no signal {name!r}; declare it under signals"
