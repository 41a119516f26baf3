"""What can be set about a robot in ROS 2: topics of its signals, odometry and commands."""

import re
from collections.abc import Iterator, Mapping
from typing import Annotated, Literal, Self, TypeAlias

from pydantic import AfterValidator, Field, model_validator

from domain.health.signals import SignalKind
from service.files.robot_settings import Number, SettingsBlock

NAV_SAT_FIX = "sensor_msgs/msg/NavSatFix"
"""The one type of which a signal is calculated, if no field is named."""

_TOPIC = r"^(/[A-Za-z_][A-Za-z0-9_]*)+$"
_TYPE = r"^[a-z][a-z0-9_]*/msg/[A-Z][A-Za-z0-9]*$"
_FIELD = r"^[a-z][a-z0-9_]*(\.([a-z][a-z0-9_]*|[0-9]+))*$"
_LONGEST = 247
"""What ROS 2 allows for the name of a topic: 255 less 8, which the middleware puts before it."""
_USUAL_FIELDS = {
    "sensor_msgs/msg/BatteryState": "percentage",
    "sensor_msgs/msg/Temperature": "temperature",
}
_PLAIN_TYPES = re.compile(r"std_msgs/msg/(Bool|String|Float(32|64)|U?Int(8|16|32|64))")


def _topic(name: str) -> str:
    if len(name) > _LONGEST or not re.fullmatch(_TOPIC, name):
        raise ValueError(f"{name!r:.60} is no full name of a topic, as /battery_state is")
    return name


def _type(name: str) -> str:
    if len(name) > _LONGEST or not re.fullmatch(_TYPE, name):
        raise ValueError(f"{name!r:.60} is no type of message, as std_msgs/msg/Bool is")
    return name


def _field(path: str) -> str:
    if len(path) > _LONGEST or not re.fullmatch(_FIELD, path):
        raise ValueError(f"{path!r:.60} is no field, as data is, or position_covariance.0")
    return path


TopicName: TypeAlias = Annotated[
    str, AfterValidator(_topic), Field(json_schema_extra={"pattern": _TOPIC})
]
MessageType: TypeAlias = Annotated[
    str, AfterValidator(_type), Field(json_schema_extra={"pattern": _TYPE})
]
FieldPath: TypeAlias = Annotated[
    str, AfterValidator(_field), Field(json_schema_extra={"pattern": _FIELD})
]
CommandType: TypeAlias = Literal[
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/TwistStamped",
    "ackermann_msgs/msg/AckermannDrive",
    "ackermann_msgs/msg/AckermannDriveStamped",
]


class SignalTopicBlock(SettingsBlock):
    """Where a signal is read from.

    Without `field`, a NavSatFix gives the accuracy of the position in mm, from its covariance.
    """

    topic: TopicName
    """Full name."""
    type: MessageType
    """Of its messages."""
    field: FieldPath | None = None
    """What of a message is the value; dots lead into it, and numbers into lists. Left out: what a
    BatteryState, a Temperature or a plain message of std_msgs holds."""
    scale: Number = 1.0
    """A number is multiplied by this; 0.01 for a battery in percent."""
    offset: Number = 0.0
    """And this is added to it then."""
    invert: bool = False
    """Whether true means false, as where a topic says that driving is enabled."""

    @property
    def path(self) -> tuple[str | int, ...] | None:
        """Return the steps into a message: fields and places in lists; None: it is calculated."""
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
            raise ValueError(f"which field of a {self.type} is the value? Say so with field")
        return self


class OdometryBlock(SettingsBlock):
    """Where the vehicle says how it moves."""

    topic: TopicName
    """Full name; of type nav_msgs/msg/Odometry, of the middle of the rear axle, in the frame in
    which waypoints are given."""


class CommandBlock(SettingsBlock):
    """Where the vehicle is told how to drive."""

    topic: TopicName
    """Full name."""
    type: CommandType
    """What the vehicle listens to. A Twist has no steering angle, so that the wheels of a vehicle
    that stands cannot be turned by it."""


class Ros2Block(SettingsBlock):
    """Topics of a robot in ROS 2."""

    signals: dict[str, SignalTopicBlock] = Field(default_factory=dict)
    """Where signals are read from, by their names: the usual five, and those that are declared."""
    odometry: OdometryBlock | None = None
    """Where the vehicle says how it moves. Left out: nobody knows, and no task is driven."""
    command: CommandBlock | None = None
    """Where the vehicle is told how to drive. Left out: it is told nothing."""

    def faults(self, kinds: Mapping[str, SignalKind]) -> Iterator[tuple[tuple[str, ...], str, str]]:
        """Tell what does not fit the signals that there are.

        Args:
            kinds: What the values of each signal are.

        Yields:
            The keys that lead to it, the code of the fault, and what it is.
        """
        types: dict[str, str] = {}
        for name, block in self.signals.items():
            place = ("signals", name)
            if types.setdefault(block.topic, block.type) != block.type:
                message = f"{block.topic} is {types[block.topic]} for another signal"
                yield (*place, "type"), "INVALID_VALUE", message
            kind = kinds.get(name)
            if kind is None:
                message = f"there is no signal {name!r}; declare it under signals"
                yield place, "UNKNOWN_SIGNAL", message
                continue
            for key in sorted({"scale", "offset"} & block.model_fields_set):
                if kind is not SignalKind.NUMBER:
                    message = f"{key} is only for numbers, and {name} is none"
                    yield (*place, key), "INVALID_VALUE", message
            if "invert" in block.model_fields_set and kind is not SignalKind.BOOLEAN:
                message = f"invert is only for true and false, and {name} is neither"
                yield (*place, "invert"), "INVALID_VALUE", message
