"""Values of parameters: their types, and when two are the same."""

from typing import NamedTuple, cast

import pytest

from domain.errors import InvalidValueError
from domain.parameters import (
    ParameterValue,
    check_values,
    fits_type,
    same_value,
    value_type,
)
from tests.support.tables import table


@pytest.mark.parametrize("value", [1, (1, 2), ()])
def test_a_value_is_the_same_as_itself(value: ParameterValue) -> None:
    assert same_value(value, value) is True


@table(
    {
        "an integer and a double": (1, 1.0),
        "an integer and a bool": (1, True),
        "a string and an integer": ("1", 1),
        "arrays of integers and of doubles": ((1, 2), (1.0, 2.0)),
        "arrays of bools and of integers": ((True,), (1,)),
        "two that are not a number": (float("nan"), float("nan")),
    }
)
def test_values_are_the_same_only_with_the_same_type(
    row: tuple[ParameterValue, ParameterValue],
) -> None:
    assert same_value(*row) is False


def test_types_are_called_as_in_ros_2() -> None:
    values: tuple[ParameterValue, ...] = (True, 1, 1.0, "a", (True,), (1,), (1.0,), ("a",))

    assert [value_type(value) for value in values] == [
        *("bool", "integer", "double", "string"),
        *("bool_array", "integer_array", "double_array", "string_array"),
    ]


@pytest.mark.parametrize("value", [None, b"x", [1.0], (None,), (1, 2.0), ((1,),)])
def test_what_no_parameter_can_hold_is_refused(value: object) -> None:
    with pytest.raises(InvalidValueError) as refused:
        value_type(cast("ParameterValue", value))

    assert refused.value.message == f"{value!r} is not a parameter value"
    with pytest.raises(InvalidValueError):
        check_values((1, cast("ParameterValue", value)))


def test_what_a_parameter_can_hold_is_taken() -> None:
    check_values((True, 1, 1.0, "a", (True,), (1,), (1.0,), ("a",), ()))


class Change(NamedTuple):
    declared: ParameterValue
    value: ParameterValue


@table(
    {
        "a double": Change(declared=1.0, value=2.0),
        "a longer array": Change(declared=(1.0,), value=(2.0, 3.0)),
        "an array where an empty one was declared": Change(declared=(), value=(2,)),
        "an empty array": Change(declared=(1.0,), value=()),
    }
)
def test_a_parameter_takes_values_of_its_own_type_and_an_empty_array_fits_all(row: Change) -> None:
    assert fits_type(row.declared, row.value) is True


@table(
    {
        "an integer for a double": Change(declared=1.0, value=2),
        "an array for a double": Change(declared=1.0, value=(2.0,)),
        "an array of integers for one of doubles": Change(declared=(1.0,), value=(2,)),
    }
)
def test_a_parameter_takes_no_value_of_another_type(row: Change) -> None:
    assert fits_type(row.declared, row.value) is False


def test_an_array_of_nothing_is_an_array_of_no_type() -> None:
    assert value_type(()) == "array"
