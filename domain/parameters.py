"""Values of ROS 2 parameters: types and equality."""

from collections.abc import Iterable, Mapping
from typing import TypeAlias

from domain.errors import InvalidValueError

ParameterValue: TypeAlias = (
    bool
    | int
    | float
    | str
    | tuple[bool, ...]
    | tuple[int, ...]
    | tuple[float, ...]
    | tuple[str, ...]
)
"""A value of a ROS 2 parameter; 1 and 1.0 differ, since their types differ."""

Parameters: TypeAlias = Mapping[str, ParameterValue]


def same_value(one: ParameterValue, other: ParameterValue) -> bool:
    """Tell whether two parameter values are equal in type and value."""
    if type(one) is not type(other) or one != other:
        return False
    return not isinstance(one, tuple) or value_type(one) == value_type(other)


def check_values(values: Iterable[ParameterValue]) -> None:
    """Check that values are parameter values.

    Raises:
        InvalidValueError: One is not.
    """
    for value in values:
        if type(value) not in _TYPE_NAMES:
            value_type(value)


def value_type(value: ParameterValue) -> str:
    """Return the type of a parameter value, such as `double` or `integer_array`; empty: `array`.

    Raises:
        InvalidValueError: It is not a parameter value.

    Source: `rcl_interfaces/msg/ParameterType`.
    """
    items = value if isinstance(value, tuple) else (value,)
    names = {_TYPE_NAMES.get(type(item), "") for item in items}
    if len(names) > 1 or "" in names:
        raise InvalidValueError(f"{value!r:.40} is not a parameter value")
    name = next(iter(names), "")
    return f"{name}_array".lstrip("_") if isinstance(value, tuple) else name


def fits_type(declared: ParameterValue, value: ParameterValue) -> bool:
    """Tell whether a parameter that holds `declared` accepts `value`; 1 does not fit 1.0.

    An empty array fits every type of array.
    """
    if isinstance(declared, tuple) and isinstance(value, tuple) and not (declared and value):
        return True
    return value_type(declared) == value_type(value)


_TYPE_NAMES: Mapping[type, str] = {bool: "bool", int: "integer", float: "double", str: "string"}
