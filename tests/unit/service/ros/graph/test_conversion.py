"""Messages to and from mappings, with classes that tell of themselves what those of ROS tell."""

import sys
from array import array
from types import ModuleType
from typing import Any, ClassVar

import numpy as np
import pytest

from domain.errors import InvalidValueError
from service.ros.graph.conversion import fields_of, fill, find_type, require_field
from service.ros.graph.graph import UnknownFieldError, UnknownTypeError


class FakeMessage:
    """Has the fields of its class, and takes whatever they are set to, as those of ROS do."""

    types: ClassVar[dict[str, str]] = {}
    defaults: ClassVar[dict[str, Any]] = {}

    def __init__(self) -> None:
        for name, default in self.defaults.items():
            setattr(self, name, default() if isinstance(default, type) else default)

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        return dict(cls.types)


class Stamp(FakeMessage):
    types: ClassVar = {"sec": "int32", "nanosec": "uint32"}
    defaults: ClassVar = {"sec": 0, "nanosec": 0}


class Header(FakeMessage):
    types: ClassVar = {"stamp": "fake_msgs/Stamp", "frame_id": "string"}
    defaults: ClassVar = {"stamp": Stamp, "frame_id": ""}


class Everything(FakeMessage):
    types: ClassVar = {
        "header": "fake_msgs/Header",
        "on": "boolean",
        "level": "octet",
        "small": "int8",
        "count": "uint64",
        "ratio": "float",
        "value": "double",
        "name": "string",
        "short": "string<3>",
        "wide": "wstring",
        "letter": "wchar",
        "names": "sequence<string>",
        "shorts": "sequence<string<3>, 2>",
        "levels": "sequence<octet>",
        "raw": "sequence<uint8>",
        "ranges": "double[3]",
        "stamps": "sequence<fake_msgs/Stamp>",
        "pair": "fake_msgs/Stamp[2]",
    }
    defaults: ClassVar = {
        "header": Header,
        "on": False,
        "level": b"\0",
        "small": 0,
        "count": 0,
        "ratio": 0.0,
        "value": 0.0,
        "name": "",
        "short": "",
        "wide": "",
        "letter": "",
        "names": list,
        "shorts": list,
        "levels": list,
        "raw": array("B"),
        "ranges": np.zeros(3),
        "stamps": list,
        "pair": None,
    }


@pytest.fixture(autouse=True)
def _installed(monkeypatch: pytest.MonkeyPatch) -> None:
    package, messages = ModuleType("fake_msgs"), ModuleType("fake_msgs.msg")
    vars(messages).update(Stamp=Stamp, Header=Header, Everything=Everything)
    monkeypatch.setitem(sys.modules, "fake_msgs", package)
    monkeypatch.setitem(sys.modules, "fake_msgs.msg", messages)


@pytest.mark.parametrize(
    ("field", "given", "held"),
    [
        ("on", True, True),
        ("level", 2, b"\x02"),
        ("small", -128, -128),
        ("count", 2**64 - 1, 2**64 - 1),
        ("ratio", 1, 1.0),
        ("value", 0.5, 0.5),
        ("value", float("inf"), float("inf")),
        ("ratio", float("-inf"), float("-inf")),
        ("name", "Größe", "Größe"),
        ("short", "abc", "abc"),
        ("wide", "中", "中"),
        ("names", ("a", "b"), ["a", "b"]),
        ("shorts", ["a", "b"], ["a", "b"]),
        ("levels", [0, 255], [b"\x00", b"\xff"]),
        ("raw", [0, 255], [0, 255]),
        ("ranges", [1, 2.5, 3], [1.0, 2.5, 3.0]),
    ],
)
def test_a_field_is_set_as_ros_wants_it(field: str, given: object, held: object) -> None:
    message = Everything()

    fill(message, {field: given})

    set_to = getattr(message, field)
    assert set_to == held
    assert type(set_to) is type(held)


def test_a_nan_is_a_float_like_others() -> None:
    message = Everything()

    fill(message, {"value": float("nan")})

    assert np.isnan(message.value)  # type: ignore[attr-defined]  # of its table


def test_nested_messages_are_made_at_any_depth() -> None:
    message: Any = Everything()

    fill(
        message,
        {
            "header": {"stamp": {"sec": 7}, "frame_id": "map"},
            "stamps": [{"sec": 1}, {"nanosec": 2}],
            "pair": [{}, {"sec": 3}],
        },
    )

    assert (message.header.stamp.sec, message.header.frame_id) == (7, "map")
    assert [(stamp.sec, stamp.nanosec) for stamp in message.stamps] == [(1, 0), (0, 2)]
    assert [stamp.sec for stamp in message.pair] == [0, 3]


def test_what_is_left_out_of_a_nested_message_has_its_default() -> None:
    message: Any = Everything()
    fill(message, {"header": {"frame_id": "map"}, "name": "kept"})

    fill(message, {"header": {"stamp": {"sec": 1}}})

    assert (message.header.frame_id, message.name) == ("", "kept")


@pytest.mark.parametrize(
    ("fields", "pointer", "wanted"),
    [
        ({"on": 1}, "/on", "true or false"),
        ({"level": 256}, "/level", "from 0 to 255"),
        ({"small": 128}, "/small", "from -128 to 127"),
        ({"small": -129}, "/small", "from -128 to 127"),
        ({"small": 1.0}, "/small", "a whole number"),
        ({"small": True}, "/small", "a whole number"),
        ({"count": -1}, "/count", "from 0 to 18446744073709551615"),
        ({"ratio": 1e39}, "/ratio", "a float can hold"),
        ({"ratio": "1"}, "/ratio", "a number"),
        ({"value": True}, "/value", "a number"),
        ({"value": 10**400}, "/value", "a double can hold"),
        ({"name": 1}, "/name", "a text"),
        ({"name": "a\0b"}, "/name", "a text"),
        ({"name": "\ud800"}, "/name", "a text"),
        ({"short": "abcd"}, "/short", "at most 3 characters"),
        ({"letter": "a"}, "/letter", "JSON cannot hold"),
        ({"names": "abc"}, "/names", "a list"),
        ({"names": ["a", 1]}, "/names/1", "a text"),
        ({"shorts": ["a", "b", "c"]}, "/shorts", "a list of at most 2"),
        ({"ranges": [1.0, 2.0]}, "/ranges", "a list of 3"),
        ({"header": [1]}, "/header", "a mapping"),
        ({"header": {"stamp": {"sec": 2**31}}}, "/header/stamp/sec", "a whole number"),
        ({"stamps": [{}, {"sec": None}]}, "/stamps/1/sec", "a whole number"),
        ({"nmae": "a"}, "/nmae", "no such field; known: header, on, level"),
        ({"header": {"stamps": {}}}, "/header/stamps", "known: stamp, frame_id"),
        ([], "", "a message must be a mapping"),
    ],
)
def test_what_is_not_of_the_type_is_refused_and_changes_nothing(
    fields: Any,  # noqa: ANN401  # all that is wrong
    pointer: str,
    wanted: str,
) -> None:
    message = Everything()
    before = fields_of(Everything())

    with pytest.raises(InvalidValueError, match=wanted) as refused:
        fill(message, fields and {"wide": "valid", **fields})

    assert refused.value.pointer == pointer
    assert fields_of(message) == before


def test_all_fields_come_back_as_they_were_given() -> None:
    fields = {
        "header": {"stamp": {"sec": 1, "nanosec": 2}, "frame_id": "map"},
        "on": True,
        "level": 2,
        "small": -1,
        "count": 3,
        "ratio": 0.5,
        "value": 0.25,
        "name": "a",
        "short": "b",
        "wide": "c",
        "names": ["d"],
        "shorts": ["e"],
        "levels": [1, 2],
        "raw": [3, 4],
        "ranges": [1.0, 2.0, 3.0],
        "stamps": [{"sec": 5, "nanosec": 6}],
        "pair": [{"sec": 7, "nanosec": 8}, {"sec": 9, "nanosec": 10}],
    }
    message = Everything()

    fill(message, fields)

    assert fields_of(message) == {**fields, "letter": ""}


def test_arrays_come_back_as_lists_of_plain_numbers() -> None:
    message: Any = Everything()
    message.raw = array("B", [1, 2])
    message.ranges = np.array([1.0, 2.0, 3.0])

    fields = fields_of(message)

    assert (fields["raw"], fields["ranges"]) == ([1, 2], [1.0, 2.0, 3.0])
    assert {type(number) for number in fields["raw"] + fields["ranges"]} == {int, float}


def test_a_type_is_found_by_its_name() -> None:
    assert find_type("fake_msgs/msg/Header") is Header


@pytest.mark.parametrize(
    "name",
    [
        "fake_msgs/msg/Footer",
        "fake_msgs/srv/Header",
        "gone_msgs/msg/Header",
        "fake_msgs/Header",
        "fake_msgs.msg/msg/Header",
        "fake_msgs/msg/Header/",
        "",
    ],
)
def test_a_type_that_is_not_there_is_named(name: str) -> None:
    with pytest.raises(
        UnknownTypeError, match=f"the ROS 2 type {name} is not installed"
    ) as missing:
        find_type(name)

    assert missing.value.type_name == name


@pytest.mark.parametrize(
    "path",
    [(), ("value",), ("header", "stamp", "sec"), ("ranges", 2), ("stamps", 7, "nanosec")],
)
def test_a_field_that_messages_have_is_found(path: tuple[str | int, ...]) -> None:
    require_field("fake_msgs/msg/Everything", path)


@pytest.mark.parametrize(
    ("path", "told"),
    [
        (("percent",), "no field percent; it has header, on"),
        (("header", "seq"), "no field header.seq; it has stamp, frame_id"),
        (("ranges", "x"), "no field ranges.x; it has none"),
        (("value", 0), "no field value.0; it has none"),
        ((0,), "no field 0; it has header, on"),
    ],
)
def test_a_field_that_no_message_has_is_told_with_those_that_there_are(
    path: tuple[str | int, ...], told: str
) -> None:
    with pytest.raises(UnknownFieldError, match=told):
        require_field("fake_msgs/msg/Everything", path)


def test_a_field_of_a_type_that_is_not_installed_is_told_as_that() -> None:
    with pytest.raises(UnknownTypeError):
        require_field("gone_msgs/msg/Gone", ("data",))
