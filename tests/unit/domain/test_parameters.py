"""Values of parameters: their types, and when two are the same."""

from typing import cast

import pytest

from domain.errors import InvalidValueError
from domain.parameters import ParameterValue, fits_type, same_value, value_type


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (1, 1, True),
        (1, 1.0, False),
        (1, True, False),
        ("1", 1, False),
        ((1, 2), (1, 2), True),
        ((1, 2), (1.0, 2.0), False),
        ((True,), (1,), False),
        ((), (), True),
        (float("nan"), float("nan"), False),
    ],
)
def test_values_are_the_same_only_with_the_same_type(
    one: ParameterValue, other: ParameterValue, same: bool
) -> None:
    assert same_value(one, other) is same


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


@pytest.mark.parametrize(
    ("declared", "value", "fits"),
    [
        (1.0, 2.0, True),
        (1.0, 2, False),
        (1.0, (2.0,), False),
        ((1.0,), (2.0, 3.0), True),
        ((1.0,), (2,), False),
        ((), (2,), True),
        ((1.0,), (), True),
    ],
)
def test_a_parameter_takes_values_of_its_own_type_and_an_empty_array_fits_all(
    declared: ParameterValue, value: ParameterValue, fits: bool
) -> None:
    assert fits_type(declared, value) is fits


def test_an_array_of_nothing_is_an_array_of_no_type() -> None:
    assert value_type(()) == "array"
