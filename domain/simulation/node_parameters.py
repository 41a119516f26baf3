"""Parameters of a simulated node: initial values, and which values it accepts."""

from collections.abc import Mapping

from domain.errors import InvalidValueError, PilothouseError, UnknownParameterError
from domain.parameters import Parameters, ParameterValue, fits_type, value_type
from domain.parts.system_model import NodeModel


def declared_parameters(node: NodeModel) -> dict[str, ParameterValue]:
    """Return every parameter that a mode of `node` sets, with a value of its type.

    If modes differ in the type, the first mode of the file decides.
    """
    declared: dict[str, ParameterValue] = {}
    for values in node.modes.values():
        for name, value in values.items():
            declared.setdefault(name, value)
    return declared


def start_parameters(declared: Parameters) -> dict[str, ParameterValue]:
    """Return the initial values of a node, before anything sets them."""
    return {name: _start_value(value) for name, value in declared.items()}


def find_refusal(declared: Parameters, values: Parameters) -> PilothouseError | None:
    """Return why a node with the `declared` parameters rejects `values`; None: it accepts them.

    As in ROS 2, types are never converted: a parameter that holds 1.0 does not accept 1.
    """
    for name, value in values.items():
        if name not in declared:
            return UnknownParameterError("parameter", name, tuple(declared))
        if not fits_type(declared[name], value):
            wanted = value_type(declared[name])
            return InvalidValueError(f"{name} is of type {wanted}, not {value_type(value)}", name)
    return None


_START_VALUES: Mapping[type, ParameterValue] = {bool: False, int: 0, float: 0.0, str: "none"}


def _start_value(value: ParameterValue) -> ParameterValue:
    return () if isinstance(value, tuple) else _START_VALUES[type(value)]
