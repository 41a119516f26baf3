"""Checks that a request names parts, modes and parameters that exist, with valid values."""

import math
from collections.abc import Mapping

from domain.errors import InvalidValueError, UnknownParameterError, UnknownPartError
from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.parameters import ParameterValue, fits_type, value_type
from domain.parts.node_facts import NodeFacts
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName


def check_request(
    model: SmhModel, facts: Mapping[PartName, NodeFacts], request: ChangeRequest
) -> PartName:
    """Return the part that a request is addressed to.

    Args:
        model: The model.
        facts: Facts about all nodes, for their parameters.
        request: What is requested.

    Raises:
        UnknownPartError: There is no such part, or parameters are requested of a system.
        UnknownModeError: The part has no such mode.
        UnknownParameterError: The node has no such parameter.
        InvalidValueError: No parameters, or a value that is not finite or of the wrong type.
    """
    if isinstance(request, ParametersRequest):
        if request.node in model.systems:
            raise UnknownPartError.of_other_kind(request.node, "node")
        if request.node not in model.nodes:
            raise UnknownPartError("node", request.node, tuple(model.nodes))
        known = facts[request.node].parameters
        if not request.values:
            raise InvalidValueError("no parameters are given")
        for name, value in request.values.items():
            _check_value(request.node, known, name, value)
        return request.node
    if request.part not in model:
        raise UnknownPartError("part", request.part, model.parts)
    if isinstance(request, ModeRequest):
        model.require_mode(request.part, request.mode)
    return request.part


def _check_value(
    node: PartName, known: Mapping[str, ParameterValue], name: str, value: ParameterValue
) -> None:
    """Compare with the reported parameters; if there are none, accept any name and type."""
    numbers = value if isinstance(value, tuple) else (value,)
    if any(isinstance(number, float) and not math.isfinite(number) for number in numbers):
        raise InvalidValueError(f"{name} must be finite", name)
    if not known:
        return
    if name not in known:
        raise UnknownParameterError(f"parameter of {node}", name, tuple(known))
    if not fits_type(known[name], value):
        wanted = value_type(known[name])
        raise InvalidValueError(f"{name} of {node} is of type {wanted}, not {value!r:.40}", name)


def describe_request(request: ChangeRequest) -> dict[str, object]:
    """Return a request as clients see it, such as `{"mode": ...}`."""
    if isinstance(request, ModeRequest):
        return {"mode": request.mode}
    if isinstance(request, TransitionRequest):
        return {"transition": str(request.transition)}
    return {"parameters": dict(request.values)}
