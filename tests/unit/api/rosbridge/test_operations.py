import json
from typing import Any

import pytest

from api.rosbridge.operations import (
    OPERATIONS,
    Authenticate,
    CallService,
    Publish,
    Subscribe,
    full_name,
    id_of,
    is_type,
    read_message,
    read_operation,
)
from domain.errors import PilothouseError


def test_what_roslib_sends_to_subscribe_is_read_with_members_that_mean_nothing_here() -> None:
    said = {
        "op": "subscribe",
        "id": "subscribe:/system_state:1",
        "type": "gem_state_msgs/SystemStateStamped",
        "topic": "/system_state",
        "compression": "none",
        "throttle_rate": 100,
        "queue_length": 0,
        "qos": {"depth": 1},
    }

    operation = read_operation(read_message({"text": json.dumps(said)}))

    assert isinstance(operation, Subscribe)
    assert (operation.topic, operation.throttle_rate) == ("/system_state", 100)
    assert operation.id == "subscribe:/system_state:1"


@pytest.mark.parametrize("args", [{"mode_name": "FAST"}, ["FAST"], [], None])
def test_a_call_has_its_values_by_name_or_in_order_or_none(args: object) -> None:
    said = {"op": "call_service", "service": "/actuation/change_mode", "args": args}

    operation = read_operation(said)

    assert isinstance(operation, CallService)
    assert operation.args == args


def test_the_message_of_rosauth_is_read_and_holds_no_token() -> None:
    said = {"op": "auth", "mac": "x", "client": "y", "dest": "z", "rand": "r", "t": 0, "end": 1}

    assert read_operation(said) == Authenticate(token=None)


def test_what_is_published_may_hold_anything() -> None:
    operation = read_operation({"op": "publish", "topic": "/x", "msg": {"data": [1, {"a": None}]}})

    assert isinstance(operation, Publish)
    assert operation.msg == {"data": [1, {"a": None}]}


@pytest.mark.parametrize(
    ("message", "words"),
    [
        ({"bytes": b"\x00"}, "binary"),
        ({"text": "{"}, "not JSON"),
        ({"text": '["subscribe"]'}, "a JSON object"),
        ({"text": '"subscribe"'}, "a JSON object"),
        ({"text": "[" * 30_000}, "nested too deeply"),
        ({"text": '{"op":"publish","topic":"\\ud800"}'}, "surrogate"),
    ],
)
def test_what_is_no_json_object_is_refused(message: dict[str, Any], words: str) -> None:
    with pytest.raises(PilothouseError, match=words):
        read_message(message)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({}, "needs an `op`"),
        ({"op": 7}, "needs an `op`"),
        ({"op": "subscibe"}, "'subscibe': there is no such operation; operations: subscribe, "),
        ({"op": "fragment", "data": "", "num": 0, "total": 1}, "whole messages in JSON"),
        ({"op": "png", "data": ""}, "whole messages in JSON"),
        ({"op": "advertise_service", "service": "/x", "type": "y"}, "cannot offer services"),
        ({"op": "send_action_goal", "action": "/x"}, "actions are not supported"),
        ({"op": "subscribe"}, "/topic"),
        ({"op": "subscribe", "topic": ""}, "/topic"),
        ({"op": "subscribe", "topic": "x" * 257}, "/topic"),
        ({"op": "subscribe", "topic": "/x", "throttle_rate": -1}, "/throttle_rate"),
        ({"op": "subscribe", "topic": "/x", "throttle_rate": float("nan")}, "/throttle_rate"),
        ({"op": "subscribe", "topic": "/x", "throttle_rate": True}, "/throttle_rate"),
        ({"op": "subscribe", "topic": "/x", "queue_length": "5"}, "/queue_length"),
        ({"op": "subscribe", "topic": "/x", "id": "x" * 257}, "/id"),
        ({"op": "subscribe", "topic": "/x", "id": 2**63}, "/id"),
        ({"op": "publish", "topic": "/x"}, "/msg"),
        ({"op": "publish", "topic": "/x", "msg": [1]}, "/msg"),
        ({"op": "call_service", "service": "/x", "args": "FAST"}, "/args"),
        ({"op": "call_service", "service": "/x", "timeout": "1"}, "/timeout"),
        ({"op": "set_level", "level": "loud"}, "/level"),
        ({"op": "auth", "token": 7}, "/token"),
    ],
)
def test_what_is_no_operation_is_refused_and_said_why(said: dict[str, Any], words: str) -> None:
    with pytest.raises(PilothouseError, match=words.replace("(", r"\(")):
        read_operation(said)


@pytest.mark.parametrize("op", OPERATIONS)
def test_each_operation_refuses_an_id_that_is_none(op: str) -> None:
    with pytest.raises(PilothouseError, match="/id"):
        read_operation({"op": op, "id": []})


@pytest.mark.parametrize(
    ("said", "found"),
    [
        ({"id": "call:1"}, "call:1"),
        ({"id": 7}, 7),
        ({}, None),
        ({"id": ["call:1"]}, None),
        ({"id": "x" * 257}, None),
        ({"id": 2**63}, None),
    ],
)
def test_an_id_is_found_also_in_a_message_that_is_wrong(
    said: dict[str, Any], found: str | int | None
) -> None:
    assert id_of(said) == found


@pytest.mark.parametrize("name", ["system_state", "/system_state"])
def test_a_name_may_lack_its_slash(name: str) -> None:
    assert full_name(name) == "/system_state"


@pytest.mark.parametrize(
    ("given", "same"),
    [
        ("std_msgs/msg/Bool", True),
        ("std_msgs/Bool", True),
        ("", True),
        (None, True),
        ("std_msgs/msg/String", False),
        ("Bool", False),
        ("std_msgs/srv/Bool", False),
    ],
)
def test_a_type_may_be_written_as_ros_1_did_or_left_out(given: str | None, same: bool) -> None:
    assert is_type(given, "std_msgs/msg/Bool") is same


@pytest.mark.parametrize(
    "offered", ["pilothouse_msgs/msg/TaskStatus", "gem_state_msgs/msg/TaskPlannerStatus"]
)
@pytest.mark.parametrize(
    ("given", "same"),
    [
        ("pilothouse_msgs/msg/TaskStatus", True),
        ("pilothouse_msgs/TaskStatus", True),
        ("gem_state_msgs/msg/TaskPlannerStatus", True),
        ("gem_state_msgs/TaskPlannerStatus", True),
        ("gem_state_msgs/TaskStatus", False),
        ("gem_state_msgs/SystemStateStamped", False),
    ],
)
def test_a_message_may_be_named_as_in_smart_polaris(offered: str, given: str, same: bool) -> None:
    assert is_type(given, offered) is same
