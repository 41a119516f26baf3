import json
from contextlib import suppress

import pytest

from domain.errors import InvalidValueError
from service.ros.interface.message_check import CHANGE_STATE, EMPTY, HEADER, Kind, Shape, checked

READING: Shape = {"header": HEADER, "enabled": Kind.BOOLEAN, "level": Kind.NUMBER}


def test_what_is_given_is_kept_and_what_is_left_out_has_the_default_of_ros() -> None:
    message = checked(READING, {"header": {"stamp": {"sec": 7}}, "level": 2})

    assert message == {
        "header": {
            "stamp": {"sec": 7, "nanosec": 0, "secs": 0, "nsecs": 0},
            "frame_id": "",
            "seq": 0,
        },
        "enabled": False,
        "level": 2,
    }


def test_a_message_may_be_empty() -> None:
    assert checked(EMPTY, {}) == {}
    assert checked(CHANGE_STATE, {}) == {"transition": {"id": 0, "label": ""}}


def test_a_field_that_does_not_exist_is_named_with_those_that_do() -> None:
    with pytest.raises(InvalidValueError, match="'name'; known: id, label") as raised:
        checked(CHANGE_STATE, {"transition": {"name": "activate"}})

    assert raised.value.pointer == "transition/name"


def test_a_request_without_fields_takes_none() -> None:
    with pytest.raises(InvalidValueError, match="no fields are expected"):
        checked(EMPTY, {"node": "drive_base"})


@pytest.mark.parametrize(
    ("kind", "value"),
    [
        (Kind.BOOLEAN, 1),
        (Kind.NUMBER, True),
        (Kind.NUMBER, "0.5"),
        (Kind.NUMBER, None),
        (Kind.TEXT, 3),
        (Kind.UINT8, 256),
        (Kind.UINT8, -1),
        (Kind.UINT8, 3.0),
        (Kind.UINT8, True),
        (Kind.INT32, 2**31),
        (Kind.UINT32, -1),
        (Kind.UINT32, 2**32),
        (Kind.UINT64, -1),
        (Kind.UINT64, 2**64),
        (Kind.NUMBER, 10**400),
        (Kind.LIST, {}),
        (Kind.LIST, "1,2"),
    ],
)
def test_a_value_of_another_type_is_refused(kind: Kind, value: object) -> None:
    with pytest.raises(InvalidValueError, match=f"value must be {kind.value}") as raised:
        checked({"value": kind}, {"value": value})

    assert raised.value.pointer == "value"


@pytest.mark.parametrize(
    ("opening", "closing", "named"), [("[", "]", "a list"), ('{"a":', "}", "fields")]
)
def test_of_a_value_that_holds_others_only_that_is_told(
    opening: str, closing: str, named: str
) -> None:
    """However deep it is: as deep as JSON can be read, which is deeper than it can be shown."""
    nested = _deepest(opening, closing)

    with pytest.raises(InvalidValueError, match=f"value must be a number, not {named}$"):
        checked({"value": Kind.NUMBER}, {"value": nested})


def _deepest(opening: str, closing: str) -> object:
    for depth in range(2_000, 0, -1):
        with suppress(RecursionError):
            found: object = json.loads(opening * depth + "1" + closing * depth)
            return found
    return None


@pytest.mark.parametrize("fields", [[], "activate", None])
def test_a_list_is_no_message(fields: object) -> None:
    with pytest.raises(InvalidValueError, match="transition must have fields by name"):
        checked(CHANGE_STATE, {"transition": fields})
