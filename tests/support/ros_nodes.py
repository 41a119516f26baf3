"""Nodes of others in a `FakeGraph`, each a process with one thread, as rclpy spins them.

A node serves one request after the other: while a callback of it runs, all others wait.
"""

import asyncio
from collections.abc import Callable, Collection, Coroutine, Mapping
from enum import StrEnum
from functools import partial
from typing import Any, TypeAlias

from domain.lifecycle import (
    ERROR_PROCESSED,
    TRANSITIONS,
    LifecycleState,
    Transition,
    TransitionRule,
    rule_for,
)
from domain.parameters import ParameterValue, value_type
from domain.simulation.node_parameters import find_refusal
from service.ros.graph.graph import Fields
from tests.support.ros_graph import DEAD_ARE_KNOWN_S, LATENCY_S, FakeGraph

LEASE_S = 0.5
"""So long after it fell silent, a publisher with a lease is missed."""

_Work: TypeAlias = tuple[Callable[[], Coroutine[Any, Any, Fields]], asyncio.Future[Fields]]


class Outcome(StrEnum):
    """What a callback of a node reports at its end."""

    SUCCESS = "success"
    FAILURE = "failure"
    ERROR = "error"


class FakeNode:
    """A node with parameters, and with or without a lifecycle; it runs from the beginning.

    Args:
        graph: Where it is.
        name: Without the leading slash.
        parameters: What it starts with; others are refused, and so are values of another type.
        plain: Whether it has no lifecycle.
        heartbeat: Whether it has a publisher whose liveliness can be watched.
    """

    def __init__(
        self,
        graph: FakeGraph,
        name: str,
        parameters: Mapping[str, ParameterValue],
        *,
        plain: bool = False,
        heartbeat: bool = False,
    ) -> None:
        self.name = name
        self.state = LifecycleState.UNCONFIGURED
        self.parameters = dict(parameters)
        self.takes_s = 0.0
        """How long each callback of a transition takes."""
        self.outcome = Outcome.SUCCESS
        """How each ends."""
        self.refuses = False
        """Whether it takes no transition at all."""
        self.loses_events = False
        """Whether what it publishes gets lost."""
        self.misses = 0
        """So many of the requests that come next it never hears."""
        self.loses_answers = False
        """Whether what it answers gets lost."""
        self._graph = graph
        self._declared = dict(parameters)
        self._heartbeat = heartbeat
        self._services = self._parameter_services() | ({} if plain else self._lifecycle_services())
        self._goes_on = asyncio.Event()
        self._inbox: asyncio.Queue[_Work]
        self._thread: asyncio.Task[None] | None = None
        self._signals = 0
        self.start()

    # --- its process -----------------------------------------------------------------------------

    def start(self) -> None:
        """Begin a process: unconfigured, with the parameters that the node starts with."""
        self._signals += 1
        self.state, self.parameters = LifecycleState.UNCONFIGURED, dict(self._declared)
        self._inbox = asyncio.Queue()
        self._goes_on.set()
        self._thread = self._graph.run(self._spin(self._inbox))
        for service, answer in self._services.items():
            self._graph.offer(f"/{self.name}/{service}", partial(self._enqueue, answer))
        self._beat()

    def kill(self) -> None:
        """End the process, as SIGKILL does: nobody in the graph is told."""
        self._signals += 1
        if self._thread is not None:
            self._thread.cancel()
            self._thread = None
        self._graph.run(self._fall_silent(forget=True))

    def stop(self) -> None:
        """Hold the process, as SIGSTOP does: what it is asked waits until it goes on."""
        self._signals += 1
        self._goes_on.clear()
        self._graph.run(self._fall_silent(forget=False))

    def go_on(self) -> None:
        """Let a held process go on, as SIGCONT does."""
        self._signals += 1
        self._goes_on.set()
        self._beat()

    def hang(self) -> None:
        """Answer nothing from now on, though the process lives and its heartbeat goes on."""
        self._goes_on.clear()

    def _beat(self) -> None:
        if self._heartbeat:
            self._graph.set_alive(f"/{self.name}/heartbeat", True)

    async def _fall_silent(self, *, forget: bool) -> None:
        signals = self._signals
        await self._graph.pass_time(LEASE_S)
        if signals != self._signals:
            return
        self._graph.set_alive(f"/{self.name}/heartbeat", False)
        await self._graph.pass_time(DEAD_ARE_KNOWN_S - LEASE_S)
        if forget and signals == self._signals:
            for service in self._services:
                self._graph.withdraw(f"/{self.name}/{service}")

    async def _enqueue(
        self, answer: Callable[[Fields], Coroutine[Any, Any, Fields]], request: Fields
    ) -> Fields:
        response: asyncio.Future[Fields] = asyncio.get_running_loop().create_future()
        if self.misses:
            self.misses -= 1
        else:
            self._inbox.put_nowait((partial(answer, request), response))
        if self.loses_answers:
            await asyncio.Event().wait()
        return await response

    async def _spin(self, inbox: asyncio.Queue[_Work]) -> None:
        while True:
            work, response = await inbox.get()
            await self._goes_on.wait()
            answer = await work()
            await self._goes_on.wait()
            response.set_result(answer)

    # --- its lifecycle ---------------------------------------------------------------------------

    def _lifecycle_services(self) -> dict[str, Callable[[Fields], Coroutine[Any, Any, Fields]]]:
        return {
            "get_state": self._get_state,
            "change_state": self._change_state,
            "get_available_transitions": self._get_available_transitions,
        }

    async def _get_state(self, _: Fields) -> Fields:
        return {"current_state": _state(self.state)}

    async def _get_available_transitions(self, _: Fields) -> Fields:
        rules = [rule for rule in TRANSITIONS if rule.start is self.state]
        return {"available_transitions": [_description(rule) for rule in rules]}

    async def _change_state(self, request: Fields) -> Fields:
        """Do as rclpy and rclcpp do: a label counts before an id, and the answer comes last."""
        asked = request["transition"]
        rules = [rule for rule in TRANSITIONS if rule.start is self.state]
        if asked.get("label"):
            found = [rule for rule in rules if rule.transition == asked["label"]]
        else:
            found = [rule for rule in rules if rule.id == asked["id"]]
        if not found or self.refuses:
            return {"success": False}
        rule = found[0]
        self._enter(rule.via, rule)
        await self._graph.pass_time(self.takes_s)
        await self._goes_on.wait()
        self._end(rule)
        return {"success": self.outcome is Outcome.SUCCESS}

    def _end(self, rule: TransitionRule) -> None:
        if self.outcome is Outcome.ERROR:
            self._enter(LifecycleState.ERROR_PROCESSING, rule)
            self._enter(ERROR_PROCESSED, rule)
        else:
            failed = self.outcome is Outcome.FAILURE
            self._enter(rule.failure if failed else rule.success, rule)

    def _enter(self, state: LifecycleState, rule: TransitionRule) -> None:
        event = {
            "timestamp": 0,
            "transition": {"id": rule.id, "label": str(rule.transition)},
            "start_state": _state(self.state),
            "goal_state": _state(state),
        }
        self.state = state
        self._publish(f"/{self.name}/transition_event", event)

    def move(self, transition: Transition) -> None:
        """Go through a transition at once, as somebody else had asked for it.

        Raises:
            ValueError: There is no such transition from where the node is.
        """
        rule = rule_for(self.state, transition)
        if rule is None:
            raise ValueError(f"{self.state} knows no {transition}")
        self._enter(rule.via, rule)
        self._enter(rule.success, rule)

    # --- its parameters --------------------------------------------------------------------------

    def _parameter_services(self) -> dict[str, Callable[[Fields], Coroutine[Any, Any, Fields]]]:
        return {
            "get_parameters": self._get_parameters,
            "set_parameters_atomically": self._set_parameters,
        }

    async def _get_parameters(self, request: Fields) -> Fields:
        """Return nothing at all if one of the names is not declared, as rclpy and rclcpp do."""
        names = request["names"]
        if not self.parameters.keys() >= set(names):
            return {"values": []}
        return {"values": [_value(self.parameters[name]) for name in names]}

    async def _set_parameters(self, request: Fields) -> Fields:
        given = {item["name"]: _given(item["value"]) for item in request["parameters"]}
        refusal = find_refusal(self.parameters, given)
        if refusal is not None:
            return {"result": {"successful": False, "reason": refusal.message}}
        self.set(given)
        return {"result": {"successful": True, "reason": ""}}

    def set(self, values: Mapping[str, ParameterValue]) -> None:
        """Set parameters at once, as somebody else had asked for it; unknown ones are declared."""
        new = values.keys() - self.parameters.keys()
        self.parameters.update(values)
        event = parameter_event(self.name, values, new)
        self._publish("/parameter_events", event)

    def _publish(self, topic: str, fields: Fields) -> None:
        if not self.loses_events:
            self._graph.run(self._publish_later(topic, fields))

    async def _publish_later(self, topic: str, fields: Fields) -> None:
        await self._graph.pass_time(LATENCY_S)
        self._graph.publish(topic, fields)


def parameter_event(
    node: str, values: Mapping[str, ParameterValue], new: Collection[str] = ()
) -> Fields:
    """Return what is published when parameters of a node were set, some of them `new` ones."""
    items = [{"name": name, "value": _value(value)} for name, value in values.items()]
    return {
        "node": f"/{node}",
        "new_parameters": [item for item in items if item["name"] in new],
        "changed_parameters": [item for item in items if item["name"] not in new],
        "deleted_parameters": [],
    }


def _state(state: LifecycleState) -> Fields:
    return {"id": state.id, "label": str(state)}


def _description(rule: TransitionRule) -> Fields:
    return {
        "transition": {"id": rule.id, "label": str(rule.transition)},
        "start_state": _state(rule.start),
        "goal_state": _state(rule.via),
    }


_FIELDS = (
    *("bool_value", "integer_value", "double_value", "string_value"),
    *("byte_array_value", "bool_array_value", "integer_array_value"),
    *("double_array_value", "string_array_value"),
)
"""Of `rcl_interfaces/msg/ParameterValue`; a value has the number of its field, from 1, as type."""


def _value(value: ParameterValue) -> Fields:
    """Return a value as ROS has it; an empty array is one of strings."""
    kind = value_type(value)
    field = f"{'string_array' if kind == 'array' else kind}_value"
    empty: dict[str, Any] = dict.fromkeys(_FIELDS[4:], ())
    scalars = {"bool_value": False, "integer_value": 0, "double_value": 0.0, "string_value": ""}
    given = list(value) if isinstance(value, tuple) else value
    return {"type": _FIELDS.index(field) + 1, **scalars, **empty, field: given}


def _given(value: Fields) -> ParameterValue:
    given = value[_FIELDS[value["type"] - 1]]
    return tuple(given) if isinstance(given, list | tuple) else given
