"""The operations of rosbridge, one per message, and how messages are parsed."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from api.http.body_parsing import check_body, parse_json
from domain.errors import InvalidValueError
from service.ros.interface.message_sets import own_type

_MAX_CHARACTERS = 256

OperationId: TypeAlias = (
    Annotated[str, Field(max_length=_MAX_CHARACTERS)] | Annotated[int, Field(ge=-(2**63), lt=2**63)]
)
"""Chosen by the client, and returned with the replies to the operation."""
Name: TypeAlias = Annotated[str, Field(min_length=1, max_length=_MAX_CHARACTERS)]
"""Of a topic or service, with or without the leading slash."""


class Operation(BaseModel):
    """One message; unknown members are ignored, since clients send many."""

    model_config = ConfigDict(extra="ignore", frozen=True, strict=True, allow_inf_nan=False)

    id: OperationId | None = None


class Subscribe(Operation):
    """Subscribe to a topic."""

    topic: Name
    type: str | None = None
    throttle_rate: Annotated[float, Field(ge=0, le=3_600_000)] = 0
    """Least time between two messages, ms."""
    queue_length: Annotated[int, Field(ge=0)] = 0
    """Messages that are queued, the oldest is dropped first; 0: the default of the topic."""
    compression: str | None = None
    fragment_size: int | None = None


class Unsubscribe(Operation):
    """End one subscription, or without an id all subscriptions of the topic."""

    topic: Name


class Advertise(Operation):
    """Announce that the client will publish to a topic."""

    topic: Name
    type: str | None = None


class Unadvertise(Operation):
    """Announce that the client publishes no more to a topic."""

    topic: Name


class Publish(Operation):
    """Publish a message."""

    topic: Name
    msg: dict[str, Any]


class CallService(Operation):
    """Call a service."""

    service: Name
    args: dict[str, Any] | list[Any] | None = None
    """Fields by name, or all values in the order of the type's definition."""
    timeout: float | None = None
    """Timeout of the response, s; None or not above 0: the longest that is allowed."""


class SetLevel(Operation):
    """Set the lowest level of status messages for the whole connection; the id is ignored."""

    level: Literal["info", "warning", "error", "none"]


class Authenticate(Operation):
    """Authenticate with the token."""

    token: str | None = None
    """None: the message is one of `rosauth`, which has no token."""


OPERATIONS: Mapping[str, type[Operation]] = MappingProxyType(
    {
        "subscribe": Subscribe,
        "unsubscribe": Unsubscribe,
        "advertise": Advertise,
        "unadvertise": Unadvertise,
        "publish": Publish,
        "call_service": CallService,
        "set_level": SetLevel,
        "auth": Authenticate,
    }
)

_WHOLE = "only whole messages in JSON are supported"
_NO_SERVERS = "clients cannot offer services"
_NO_ACTIONS = "actions are not supported"
_NOT_HERE: Mapping[str, str] = MappingProxyType(
    {
        "fragment": _WHOLE,
        "png": _WHOLE,
        "cbor": _WHOLE,
        "cbor-raw": _WHOLE,
        "advertise_service": _NO_SERVERS,
        "unadvertise_service": _NO_SERVERS,
        "service_response": _NO_SERVERS,
        "advertise_action": _NO_ACTIONS,
        "unadvertise_action": _NO_ACTIONS,
        "send_action_goal": _NO_ACTIONS,
        "cancel_action_goal": _NO_ACTIONS,
        "action_feedback": _NO_ACTIONS,
        "action_result": _NO_ACTIONS,
    }
)
"""Operations of the protocol that are not supported, and why."""


def read_message(message: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the JSON object that a client sent.

    Args:
        message: An ASGI message with `text` or `bytes`.

    Raises:
        PilothouseError: It is not a JSON object.
    """
    text = message.get("text")
    if text is None:
        raise InvalidValueError("binary messages (BSON, CBOR) are not supported; send JSON as text")
    said = parse_json(text.encode())
    if not isinstance(said, dict):
        raise InvalidValueError("a message is a JSON object with an `op`")
    return said


def id_of(said: Mapping[str, Any]) -> str | int | None:
    """Return the id of a message, even of an invalid one; None: it has no valid id."""
    found = said.get("id")
    if isinstance(found, str) and len(found) <= _MAX_CHARACTERS:
        return found
    return found if isinstance(found, int) and abs(found) < 2**63 else None


def read_operation(said: Mapping[str, Any]) -> Operation:
    """Return the operation of a message.

    Args:
        said: Returned by `read_message`.

    Raises:
        PilothouseError: It is no operation, or an unsupported one, or its members are invalid.
    """
    op = said.get("op")
    known = ", ".join(OPERATIONS)
    if not isinstance(op, str):
        raise InvalidValueError(f"a message needs an `op`, one of: {known}", "/op")
    kind = OPERATIONS.get(op)
    if kind is None:
        why = _NOT_HERE.get(op, "there is no such operation")
        raise InvalidValueError(f"op {op[:40]!r}: {why}; operations: {known}", "/op")
    return check_body(kind, said)


def full_name(name: str) -> str:
    """Return the name of a topic or service with its leading slash."""
    return name if name.startswith("/") else f"/{name}"


def is_type(given: str | None, type_name: str) -> bool:
    """Tell whether a type that a client names matches `type_name`.

    Args:
        given: As in ROS 2 (`std_msgs/msg/Bool`) or in ROS 1 (`std_msgs/Bool`), in either of the
            packages of `message_sets`; None or empty: any.
        type_name: As in ROS 2.
    """
    if not given:
        return True
    package, _, rest = given.partition("/")
    folder = type_name.split("/")[1]
    full = given if "/" in rest else f"{package}/{folder}/{rest}"
    return own_type(full) == own_type(type_name)
