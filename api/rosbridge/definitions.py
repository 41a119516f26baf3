"""Definitions of the offered message and service types, as viewers need them to decode messages.

They are those of the packages themselves; fields of other types are named with their package.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from service.ros.interface.endpoints import Fields
from service.ros.interface.message_sets import ALIASES

SCALAR = -1
"""Length of a field that is no array, in `rosapi_msgs/msg/TypeDef`; 0 is an array of any length."""

_HEADER = "std_msgs/Header header"
_XYZ = ("float64 x", "float64 y", "float64 z")
_SECONDS = ("int32 sec", "uint32 nanosec")

_MESSAGES: Mapping[str, tuple[str, ...]] = {
    "pilothouse_msgs/msg/BatteryLevel": (_HEADER, "float32 battery_level"),
    "pilothouse_msgs/msg/EmergencyStop": (_HEADER, "bool enabled"),
    "pilothouse_msgs/msg/GpsAccuracy": (_HEADER, "float32 accuracy"),
    "pilothouse_msgs/msg/SignalStrength": (
        "uint8 NOT_CONNECTED=0",
        "uint8 CONNECTED=1",
        "uint8 LOW_SIGNAL=2",
        _HEADER,
        "uint8 strength",
    ),
    "pilothouse_msgs/msg/SystemState": (
        "uint8 ERROR_NONE=0",
        "uint8 ERROR_BATTERY_LOW=1",
        "uint8 ERROR_ESTOP=2",
        "uint8 ERROR_GPS_LOST=4",
        "uint8 ERROR_SIGNAL_LOST=8",
        "uint8 ERROR_SIGNAL_LOW=16",
        "uint8 ERROR_TEMPERATURE_HIGH=32",
        "uint8 ERROR_STALE_DATA=64",
        "uint8 STATE_IDLE=0",
        "uint8 STATE_RUNNING=1",
        "uint8 STATE_ERROR=2",
        _HEADER,
        "uint8 error_code",
        "uint8 state",
    ),
    "pilothouse_msgs/msg/TaskStatus": (
        "uint8 STATUS_NO_TASK=0",
        "uint8 STATUS_PAUSED_TASK=1",
        "uint8 STATUS_RUNNING_TASK=2",
        _HEADER,
        "uint8 status",
    ),
    "pilothouse_msgs/msg/Temperature": (_HEADER, "float32 temperature"),
    "pilothouse_msgs/msg/Waypoint": ("float64 x_m", "float64 y_m", "float64 yaw_rad"),
    "system_modes_msgs/msg/Mode": ("string label",),
    "system_modes_msgs/msg/ModeEvent": (
        "uint64 timestamp",
        "system_modes_msgs/Mode start_mode",
        "system_modes_msgs/Mode goal_mode",
    ),
    "lifecycle_msgs/msg/State": ("uint8 id", "string label"),
    "lifecycle_msgs/msg/Transition": ("uint8 id", "string label"),
    "lifecycle_msgs/msg/TransitionDescription": (
        "lifecycle_msgs/Transition transition",
        "lifecycle_msgs/State start_state",
        "lifecycle_msgs/State goal_state",
    ),
    "lifecycle_msgs/msg/TransitionEvent": (
        "uint64 timestamp",
        "lifecycle_msgs/Transition transition",
        "lifecycle_msgs/State start_state",
        "lifecycle_msgs/State goal_state",
    ),
    "diagnostic_msgs/msg/DiagnosticArray": (
        _HEADER,
        "diagnostic_msgs/DiagnosticStatus[] status",
    ),
    "diagnostic_msgs/msg/DiagnosticStatus": (
        "byte OK=0",
        "byte WARN=1",
        "byte ERROR=2",
        "byte STALE=3",
        "byte level",
        "string name",
        "string message",
        "string hardware_id",
        "diagnostic_msgs/KeyValue[] values",
    ),
    "diagnostic_msgs/msg/KeyValue": ("string key", "string value"),
    "visualization_msgs/msg/MarkerArray": ("visualization_msgs/Marker[] markers",),
    "visualization_msgs/msg/Marker": (
        "int32 ARROW=0",
        "int32 CUBE=1",
        "int32 SPHERE=2",
        "int32 CYLINDER=3",
        "int32 LINE_STRIP=4",
        "int32 LINE_LIST=5",
        "int32 CUBE_LIST=6",
        "int32 SPHERE_LIST=7",
        "int32 POINTS=8",
        "int32 TEXT_VIEW_FACING=9",
        "int32 MESH_RESOURCE=10",
        "int32 TRIANGLE_LIST=11",
        "int32 ARROW_STRIP=12",
        "int32 ADD=0",
        "int32 MODIFY=0",
        "int32 DELETE=2",
        "int32 DELETEALL=3",
        _HEADER,
        "string ns",
        "int32 id",
        "int32 type",
        "int32 action",
        "geometry_msgs/Pose pose",
        "geometry_msgs/Vector3 scale",
        "std_msgs/ColorRGBA color",
        "builtin_interfaces/Duration lifetime",
        "bool frame_locked",
        "geometry_msgs/Point[] points",
        "std_msgs/ColorRGBA[] colors",
        "string texture_resource",
        "sensor_msgs/CompressedImage texture",
        "visualization_msgs/UVCoordinate[] uv_coordinates",
        "string text",
        "string mesh_resource",
        "visualization_msgs/MeshFile mesh_file",
        "bool mesh_use_embedded_materials",
    ),
    "visualization_msgs/msg/MeshFile": ("string filename", "uint8[] data"),
    "visualization_msgs/msg/UVCoordinate": ("float32 u", "float32 v"),
    "sensor_msgs/msg/CompressedImage": (_HEADER, "string format", "uint8[] data"),
    "nav_msgs/msg/Path": (_HEADER, "geometry_msgs/PoseStamped[] poses"),
    "geometry_msgs/msg/PoseStamped": (_HEADER, "geometry_msgs/Pose pose"),
    "geometry_msgs/msg/Pose": (
        "geometry_msgs/Point position",
        "geometry_msgs/Quaternion orientation",
    ),
    "geometry_msgs/msg/Point": _XYZ,
    "geometry_msgs/msg/Vector3": _XYZ,
    "geometry_msgs/msg/Quaternion": (*_XYZ, "float64 w"),
    "std_msgs/msg/ColorRGBA": ("float32 r", "float32 g", "float32 b", "float32 a"),
    "std_msgs/msg/String": ("string data",),
    "std_msgs/msg/Header": ("builtin_interfaces/Time stamp", "string frame_id"),
    "builtin_interfaces/msg/Duration": _SECONDS,
    "builtin_interfaces/msg/Time": _SECONDS,
}
MESSAGES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {**_MESSAGES, **{alias: _MESSAGES[own] for alias, own in ALIASES.items()}}
)
"""Lines by type: constants, then fields."""

_EMPTY: tuple[str, ...] = ()
_TASK = ("bool success", "string message", "string task")

SERVICES: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = MappingProxyType(
    {
        "lifecycle_msgs/srv/GetState": (_EMPTY, ("lifecycle_msgs/State current_state",)),
        "lifecycle_msgs/srv/GetAvailableStates": (
            _EMPTY,
            ("lifecycle_msgs/State[] available_states",),
        ),
        "lifecycle_msgs/srv/GetAvailableTransitions": (
            _EMPTY,
            ("lifecycle_msgs/TransitionDescription[] available_transitions",),
        ),
        "lifecycle_msgs/srv/ChangeState": (
            ("lifecycle_msgs/Transition transition",),
            ("bool success",),
        ),
        "system_modes_msgs/srv/GetMode": (_EMPTY, ("string current_mode",)),
        "system_modes_msgs/srv/GetAvailableModes": (_EMPTY, ("string[] available_modes",)),
        "system_modes_msgs/srv/ChangeMode": (("string mode_name",), ("bool success",)),
        "std_srvs/srv/Empty": (_EMPTY, _EMPTY),
        "pilothouse_msgs/srv/StartTask": (
            ("string file", "uint64 start_index", "string controller", "float64 speed_mps"),
            _TASK,
        ),
        "pilothouse_msgs/srv/DriveWaypoints": (
            (
                "pilothouse_msgs/Waypoint[] waypoints",
                "uint64 start_index",
                "string controller",
                "float64 speed_mps",
            ),
            _TASK,
        ),
    }
)
"""Fields of the request and of the response, by type."""

_EXAMPLES = {"bool": "False", "string": "", "float32": "0.0", "float64": "0.0"}
_SEPARATOR = "=" * 80


def full_type(name: str) -> str:
    """Return the name of a message type as in ROS 2; that of ROS 1 has no `msg` in it."""
    package, slash, rest = name.partition("/")
    return f"{package}/msg/{rest}" if slash and "/" not in rest else name


def full_text(type_name: str) -> str:
    """Return the definition of a message type, followed by those of the types in it.

    This is the layout of `gendeps --cat`. An unknown type has an empty text.
    """
    found = list(_with_nested(full_type(type_name)))
    parts = ["\n".join(MESSAGES[name]) for name in found]
    heads = [f"{_SEPARATOR}\nMSG: {name.replace('/msg/', '/')}\n" for name in found]
    return "\n".join([*parts[:1], *(a + b for a, b in zip(heads[1:], parts[1:], strict=True))])


def type_definitions(type_name: str) -> list[Fields]:
    """Return a message type and the types in it as `rosapi_msgs/msg/TypeDef`; empty: unknown."""
    return [_type_definition(name, MESSAGES[name]) for name in _with_nested(full_type(type_name))]


def service_definitions(type_name: str, *, of_response: bool) -> list[Fields]:
    """Return the request or response of a service type, and the types in it; empty: unknown."""
    package, _, rest = type_name.partition("/")
    name = f"{package}/srv/{rest.removeprefix('srv/')}"
    if name not in SERVICES:
        return []
    lines = SERVICES[name][of_response]
    nested = (full_type(field.type) for field in _fields(lines) if "/" in field.type)
    below = dict.fromkeys(inner for type_ in nested for inner in _with_nested(type_))
    own = f"{name}_{'Response' if of_response else 'Request'}"
    return [_type_definition(own, lines), *(_type_definition(n, MESSAGES[n]) for n in below)]


@dataclass(frozen=True, slots=True)
class _Field:
    type: str
    name: str
    length: int


def _fields(lines: tuple[str, ...]) -> Iterator[_Field]:
    for line in lines:
        if "=" not in line:
            type_name, _, name = line.partition(" ")
            bare = type_name.removesuffix("[]")
            yield _Field(bare, name, SCALAR if bare == type_name else 0)


def _with_nested(name: str) -> Iterator[str]:
    """Yield a message type and all types in it, each once; nothing if it is unknown."""
    found = dict.fromkeys([name] if name in MESSAGES else [])
    waiting = [*found]
    while waiting:
        for field in _fields(MESSAGES[waiting.pop(0)]):
            inner = full_type(field.type)
            if inner in MESSAGES and inner not in found:
                found[inner] = None
                waiting.append(inner)
    yield from found


def _type_definition(name: str, lines: tuple[str, ...]) -> Fields:
    fields = list(_fields(lines))
    constants = [line.partition(" ")[2].partition("=") for line in lines if "=" in line]
    return {
        "type": name,
        "fieldnames": [field.name for field in fields],
        # As the types themselves are named, so that a client finds them.
        "fieldtypes": [full_type(field.type) for field in fields],
        "fieldarraylen": [field.length for field in fields],
        "examples": [_example(field) for field in fields],
        "constnames": [name for name, _, _ in constants],
        "constvalues": [value for _, _, value in constants],
    }


def _example(field: _Field) -> str:
    if field.length != SCALAR:
        return "[]"
    return "{}" if "/" in field.type else _EXAMPLES.get(field.type, "0")
