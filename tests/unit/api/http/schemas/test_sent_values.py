"""Values that may be of several types are read strictly, with one clear message."""

import math

import pytest
from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from api.http.schemas.sent_values import (
    MAX_ITEMS,
    MAX_TEXT,
    SentMoment,
    SentParameter,
    SentSignalValue,
    read_parameter_value,
    read_signal_value,
    split_label,
)


@pytest.mark.parametrize(
    ("sent", "value"), [(1, 1.0), (0.5, 0.5), (True, True), ("CONNECTED", "CONNECTED"), (-0.0, 0.0)]
)
def test_a_signal_is_a_boolean_a_number_or_a_text(sent: object, value: object) -> None:
    found = read_signal_value(sent)

    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    "sent", [math.nan, math.inf, -math.inf, 10**400, None, [1], {}, "x" * 5_000]
)
def test_a_signal_is_nothing_else(sent: object) -> None:
    with pytest.raises(PydanticCustomError):
        read_signal_value(sent)


@pytest.mark.parametrize(
    ("sent", "value"),
    [
        (1, 1),
        (1.0, 1.0),
        (True, True),
        ("PID", "PID"),
        (2**63 - 1, 2**63 - 1),
        ([1, 2], (1, 2)),
        ([0.5, 1], (0.5, 1.0)),
        ([True, False], (True, False)),
        (["a"], ("a",)),
        ([], ()),
    ],
)
def test_a_parameter_keeps_its_type(sent: object, value: object) -> None:
    found = read_parameter_value(sent)

    assert (found, type(found)) == (value, type(value))
    if isinstance(found, tuple) and isinstance(value, tuple):
        assert [type(item) for item in found] == [type(item) for item in value]


@pytest.mark.parametrize(
    "sent",
    [None, {}, math.nan, [math.inf], 2**63, -(2**63) - 1, [1, True], ["a", 1], [[1]], [None]],
)
def test_a_parameter_is_nothing_that_ros_has_not(sent: object) -> None:
    with pytest.raises(PydanticCustomError):
        read_parameter_value(sent)


@pytest.mark.parametrize("sent", ["x" * MAX_TEXT, ["x" * MAX_TEXT], [0] * MAX_ITEMS])
def test_a_parameter_may_be_as_long_as_said(sent: object) -> None:
    assert read_parameter_value(sent)


@pytest.mark.parametrize(
    ("sent", "message"),
    [
        ("x" * (MAX_TEXT + 1), "4096 characters"),
        (["a", "x" * (MAX_TEXT + 1)], "4096 characters"),
        ([0] * (MAX_ITEMS + 1), "1024 items"),
    ],
)
def test_a_parameter_that_is_too_long_is_told_the_limit(sent: object, message: str) -> None:
    with pytest.raises(PydanticCustomError, match=message):
        read_parameter_value(sent)


@pytest.mark.parametrize("adapter", [TypeAdapter(SentSignalValue), TypeAdapter(SentParameter)])
def test_one_fault_is_told_once(adapter: TypeAdapter[object]) -> None:
    with pytest.raises(ValidationError) as raised:
        adapter.validate_python(None)

    assert raised.value.error_count() == 1


@pytest.mark.parametrize(
    ("label", "pair"),
    [
        ("active.FAST", {"state": "active", "mode": "FAST"}),
        ("inactive", {"state": "inactive", "mode": None}),
        ("active.", {"state": "active", "mode": None}),
        ("active.A.B", {"state": "active", "mode": "A.B"}),
        (None, None),
        (1, 1),
    ],
)
def test_a_label_is_split_at_its_first_dot(label: object, pair: object) -> None:
    assert split_label(label) == pair


@pytest.mark.parametrize("sent", ["2026-05-04T12:00:00Z", "2026-05-04 14:00:00.25+02:00"])
def test_a_moment_has_a_date_and_an_offset(sent: str) -> None:
    found = TypeAdapter(SentMoment).validate_python(sent)

    assert (found.year, found.utcoffset() is not None) == (2026, True)


@pytest.mark.parametrize("sent", ["17", "0.5", 17, 1.7e9, "2026-05-04T12:00:00", "now", ""])
def test_seconds_since_1970_are_no_moment(sent: object) -> None:
    with pytest.raises(ValidationError):
        TypeAdapter(SentMoment).validate_python(sent)
