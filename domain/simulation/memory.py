"""What a simulated robot remembers over a restart, as a real one outlives its supervisor.

Plain values that JSON can hold. What cannot be read back is left out with a reason, and begins as
without a memory.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from domain.errors import InvalidValueError, shortened
from domain.lifecycle import LifecycleState, arrival
from domain.parameters import Parameters, ParameterValue, value_type
from domain.parts.system_model import SmhModel
from domain.paths.waypoints import MAX_COORDINATE_M
from domain.simulation.node_parameters import declared_parameters, find_refusal
from domain.state_and_mode import PartName
from domain.vehicle import Pose, VehicleState

_VEHICLE = ("x_m", "y_m", "yaw_rad", "steering_angle_rad")
_MOST_TOLD = 20
"""Largest number of reasons; more would not be read."""


@dataclass(frozen=True, slots=True)
class NodeMemory:
    """Where a simulated node was."""

    state: LifecycleState
    """A primary one; `unknown` for a plain node."""
    parameters: Parameters = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Memory:
    """What could be read back."""

    nodes: Mapping[PartName, NodeMemory] = field(default_factory=dict)
    vehicle: VehicleState | None = None
    """At standstill; None: nothing is remembered."""
    left_out: tuple[str, ...] = ()
    """What could not be read back, and why, in words."""


def rest_of(state: LifecycleState) -> LifecycleState:
    """Return the state in which a node that was interrupted in `state` is found again.

    A transition ends where it was going, except that no node becomes active while nobody watches.
    """
    return LifecycleState.INACTIVE if state is LifecycleState.ACTIVATING else arrival(state)


def plain_nodes(
    state: LifecycleState, parameters: Parameters, names: Sequence[PartName]
) -> dict[str, object]:
    """Return nodes that are all in the same state, with the same parameters, as plain values."""
    return {"state": str(rest_of(state)), "parameters": dict(parameters), "nodes": names}


def plain_vehicle(state: VehicleState) -> dict[str, object]:
    """Return where a vehicle is as plain values; not how fast it drives."""
    pose = state.pose
    numbers = (pose.x_m, pose.y_m, pose.yaw_rad, state.steering_angle_rad)
    return dict(zip(_VEHICLE, numbers, strict=True))


def read_memory(memory: object, model: SmhModel) -> Memory:
    """Read what `SimulatedRobot.memory` returned, in this run or an earlier one.

    Nodes and parameters that the model no longer has are ignored. Nothing is raised.

    Args:
        memory: Anything; None: there is none.
        model: The nodes to simulate.
    """
    if memory is None:
        return Memory()
    if not isinstance(memory, Mapping):
        return Memory(left_out=("the memory of the simulated robot is not a mapping",))
    left_out: list[str] = []
    nodes = _read_nodes(memory.get("nodes", ()), model, left_out)
    vehicle = _read_vehicle(memory.get("vehicle"), left_out)
    more = len(left_out) - _MOST_TOLD
    told = [*left_out[:_MOST_TOLD], *([f"and {more} more"] if more > 0 else [])]
    return Memory(nodes, vehicle, tuple(told))


def _read_nodes(given: object, model: SmhModel, left_out: list[str]) -> dict[PartName, NodeMemory]:
    if not isinstance(given, Sequence) or isinstance(given, str):
        left_out.append("the memory of the simulated nodes is not a list")
        return {}
    found: dict[PartName, NodeMemory] = {}
    for group in given:
        try:
            found |= _read_group(group, model, left_out)
        except InvalidValueError as error:
            left_out.append(f"the memory of some simulated nodes: {error.message}")
    return found


def _read_group(given: object, model: SmhModel, left_out: list[str]) -> dict[PartName, NodeMemory]:
    """Return the nodes that are all in the same state, with the same parameters.

    Raises:
        InvalidValueError: No node can be so.
    """
    names, named, values = _fields(given)
    state = next((state for state in LifecycleState if state == named), None)
    if state is None or not (state.is_primary or state is LifecycleState.UNKNOWN):
        raise InvalidValueError(f"{shortened(repr(named), 40)} is not a state to rest in")
    parameters = {name: _parameter(value) for name, value in values.items()}
    found: dict[PartName, NodeMemory] = {}
    for name in names:
        if not isinstance(name, str) or name not in model.nodes:
            continue
        node = PartName(name)
        declared = declared_parameters(model.nodes[node])
        known = {name: parameters[name] for name in declared if name in parameters}
        refusal = find_refusal(declared, known)
        if refusal is None:
            found[node] = NodeMemory(state, known)
        else:
            left_out.append(f"the memory of the simulated node {name}: {refusal.message}")
    return found


def _fields(given: object) -> tuple[Sequence[object], object, Mapping[str, object]]:
    """Return names, state and parameters.

    Raises:
        InvalidValueError: There are no such fields.
    """
    if not isinstance(given, Mapping):
        raise InvalidValueError("it is not a mapping")
    names, values = given.get("nodes"), given.get("parameters")
    if not isinstance(names, Sequence) or isinstance(names, str):
        raise InvalidValueError("its nodes are not a list")
    if not isinstance(values, Mapping):
        raise InvalidValueError("its parameters are not a mapping")
    return names, given.get("state"), values


def _parameter(value: object) -> ParameterValue:
    """Return a value with its list as a tuple again.

    Raises:
        InvalidValueError: It is not a parameter value.
    """
    is_list = isinstance(value, Sequence) and not isinstance(value, str)
    found: ParameterValue = tuple(value) if is_list else value  # type: ignore[arg-type,assignment]
    value_type(found)
    return found


def _read_vehicle(given: object, left_out: list[str]) -> VehicleState | None:
    if given is None:
        return None
    numbers = [given.get(name) for name in _VEHICLE] if isinstance(given, Mapping) else []
    limits = (MAX_COORDINATE_M, MAX_COORDINATE_M, math.pi, math.pi)
    if len(numbers) != len(limits) or not all(map(_is_within, numbers, limits)):
        left_out.append("the memory of the simulated vehicle is not a pose that it can have")
        return None
    x_m, y_m, yaw_rad, steering_angle_rad = map(float, numbers)  # type: ignore[arg-type]
    return VehicleState(Pose(x_m, y_m, yaw_rad), 0.0, steering_angle_rad)


def _is_within(number: object, limit: float) -> bool:
    """Tell whether something is a finite number of at most `limit` to either side."""
    is_number = isinstance(number, int | float) and not isinstance(number, bool)
    return is_number and abs(number) <= limit  # type: ignore[arg-type]
