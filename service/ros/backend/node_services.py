"""Calls the services of one node, in terms of the core."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from domain.commands import AskTransition, NodeCommand
from domain.lifecycle import TRANSITIONS, LifecycleState, Transition, rule_for
from domain.parameters import Parameters, ParameterValue, same_value, value_type
from domain.state_and_mode import PartName
from service.ros.graph.graph import Fields, Message, RosNode

LOOK_WITHIN_S = 0.8
"""Timeout of a query, s."""
ANSWER_WITHIN_S = 60.0
"""Timeout of a command, s: longer than whoever sent it waits."""


@dataclass(frozen=True, slots=True)
class Askers:
    """Our own ROS nodes that have the service clients, by what they query."""

    states: RosNode
    transitions: RosNode
    parameters: RosNode


class NodeServices:
    """The services of a node, which need not be running yet.

    Each call raises TimeoutError if there is no response in time. Whether the node processed the
    request is not known then.
    """

    def __init__(self, name: PartName, ours: Askers) -> None:
        """Prepare.

        Args:
            name: Of the node that has the services.
            ours: The nodes that have the clients.

        Raises:
            UnknownTypeError: A type is not installed.
        """
        states, transitions, parameters = ours.states, ours.transitions, ours.parameters
        self._get_state = states.client(f"/{name}/get_state", "lifecycle_msgs/srv/GetState")
        self._change_state = transitions.client(
            f"/{name}/change_state", "lifecycle_msgs/srv/ChangeState"
        )
        self._available = transitions.client(
            f"/{name}/get_available_transitions", "lifecycle_msgs/srv/GetAvailableTransitions"
        )
        self._get_parameters = parameters.client(
            f"/{name}/get_parameters", "rcl_interfaces/srv/GetParameters"
        )
        self._set_parameters = parameters.client(
            f"/{name}/set_parameters_atomically", "rcl_interfaces/srv/SetParametersAtomically"
        )

    @property
    def has_lifecycle(self) -> bool:
        """Tell whether the graph knows that the node has a lifecycle."""
        return self._get_state.is_ready()

    @property
    def processes(self) -> int:
        """Return how many processes of the node the graph knows, including dead ones."""
        return self._get_state.servers()

    @property
    def has_parameters(self) -> bool:
        """Tell whether the graph knows a parameter service of the node."""
        return self._get_parameters.is_ready()

    @property
    def are_complete(self) -> bool:
        """Tell whether the graph knows all services of a node with lifecycle and parameters."""
        others = (self._change_state, self._set_parameters)
        return self.has_lifecycle and self.has_parameters and all(c.is_ready() for c in others)

    async def state(self) -> LifecycleState:
        """Return the lifecycle state of the node."""
        response = await self._get_state.call({}, LOOK_WITHIN_S)
        return read_state(response.current_state)

    async def available_transitions(self) -> tuple[str, ...]:
        """Return the labels of the transitions that the node offers now."""
        response = await self._available.call({}, LOOK_WITHIN_S)
        return tuple(item.transition.label for item in response.available_transitions)

    async def change_state(self, transition: Transition, start: LifecycleState | None) -> bool:
        """Request a transition; return whether it succeeded, once that is known.

        Args:
            transition: The node finds it by its label, or else by its number.
            start: State of the node, None if unknown; needed for the number, since each start
                state has its own transition of the same label.
        """
        asked = {"id": _number(transition, start), "label": str(transition)}
        response = await self._change_state.call({"transition": asked}, ANSWER_WITHIN_S)
        return bool(response.success)

    async def parameters(self, names: Iterable[str]) -> dict[str, ParameterValue]:
        """Return those of the parameters that are declared and set."""
        asked = list(names)
        values = await self._values(asked)
        if len(values) != len(asked):
            # If one of them is not declared, the response holds none of the others either.
            found = [(name, await self._values([name])) for name in asked]
            return _known((name, values[0]) for name, values in found if values)
        return _known(zip(asked, values, strict=True))

    async def _values(self, names: list[str]) -> list[Message]:
        response = await self._get_parameters.call({"names": names}, LOOK_WITHIN_S)
        return list(response.values)

    async def set_parameters(self, values: Parameters, known: Parameters) -> str:
        """Set parameters, all or none; return why the node rejected them, empty on success.

        Args:
            values: The new values.
            known: The current values, which determine the type of an empty array.

        Raises:
            InvalidValueError: A value is outside the range of ROS; nothing was sent.
        """
        parameters = [
            {"name": name, "value": write_value(value, known.get(name))}
            for name, value in values.items()
        ]
        response = await self._set_parameters.call({"parameters": parameters}, ANSWER_WITHIN_S)
        result = response.result
        return "" if result.successful else result.reason or "the node rejected the values"


def read_state(message: Message) -> LifecycleState:
    """Return the state of a `lifecycle_msgs/msg/State`; UNKNOWN for an id that is not standard.

    By its id, since labels are not standardized.
    """
    return _STATES.get(message.id, LifecycleState.UNKNOWN)


_STATES: Mapping[int, LifecycleState] = {state.id: state for state in LifecycleState}


def _number(transition: Transition, start: LifecycleState | None) -> int:
    rule = None if start is None else rule_for(start, transition)
    return rule.id if rule else next(r.id for r in TRANSITIONS if r.transition is transition)


def read_parameters(messages: Iterable[Message]) -> dict[str, ParameterValue]:
    """Return the parameters in a sequence of `rcl_interfaces/msg/Parameter`."""
    return _known((message.name, message.value) for message in messages)


def _known(items: Iterable[tuple[str, Message]]) -> dict[str, ParameterValue]:
    read = ((name, _read_value(value)) for name, value in items)
    return {name: value for name, value in read if value is not None}


def _read_value(message: Message) -> ParameterValue | None:
    """Return a value; None: it is not set, or is a byte array, which no mode can set."""
    name = next((name for name, number in _NUMBERS.items() if number == message.type), None)
    if name is None:
        return None
    value = getattr(message, f"{name}_value")
    read = _TYPES[name.removesuffix("_array")]
    result: ParameterValue = (
        tuple(read(item) for item in value) if name.endswith("_array") else read(value)
    )
    return result


def begins(command: NodeCommand, start: LifecycleState, goal: LifecycleState) -> bool:
    """Tell whether a transition from `start` to `goal` is the first step of a command."""
    if not isinstance(command, AskTransition):
        return False
    rule = rule_for(start, command.transition)
    return rule is not None and rule.via is goal


def holds_all(known: Parameters | None, values: Parameters) -> bool:
    """Tell whether all `values` are known to be set."""
    if known is None:
        return False
    return all(name in known and same_value(known[name], v) for name, v in values.items())


def write_value(value: ParameterValue, known: ParameterValue | None = None) -> Fields:
    """Return a value as the fields of a `rcl_interfaces/msg/ParameterValue`.

    Args:
        value: The value.
        known: The current value of the parameter; an empty array gets its type, or else strings.
    """
    name = value_type(value)
    if name == "array":
        name = value_type(known) if isinstance(known, tuple) and known else "string_array"
    items = list(value) if isinstance(value, tuple) else value
    return {"type": _NUMBERS[name], f"{name}_value": items}


_TYPES: Mapping[str, Callable[[Any], Any]] = {
    "bool": bool,
    "integer": int,
    "double": float,
    "string": str,
}
_NUMBERS: Mapping[str, int] = {
    "bool": 1,
    "integer": 2,
    "double": 3,
    "string": 4,
    "bool_array": 6,
    "integer_array": 7,
    "double_array": 8,
    "string_array": 9,
}
"""Of the types in `rcl_interfaces/msg/ParameterType`, by their names in `value_type`."""
