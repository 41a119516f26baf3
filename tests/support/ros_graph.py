"""A ROS 2 graph in memory and in virtual time, with nodes in it that can be made to fail.

Messages and responses have one attribute per field that was given; nothing has a default. What is
published is heard at once, before `publish` returns; requests and responses take `LATENCY_S` each.
"""

import asyncio
import logging
from collections import Counter, defaultdict
from collections.abc import Awaitable, Callable, Coroutine, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, TypeAlias

from domain.controller import GoalOutcome
from domain.errors import InvalidValueError
from domain.graph_terms import GraphFault
from domain.timebase import NANOSECONDS_PER_SECOND, seconds, to_seconds
from domain.vehicle import DriveCommand
from service.clock import since_epoch
from service.pacing import Alarm
from service.ros.graph.drive import Deadman, drive_message
from service.ros.graph.graph import (
    OWNER,
    ActionHandler,
    Fields,
    GoalT,
    GraphFailedError,
    Lane,
    Message,
    PickedT,
    Qos,
    UnknownFieldError,
    UnknownTypeError,
)
from tests.support.manual_clock import ManualClock

LATENCY_S = 0.001
DEAD_ARE_KNOWN_S = 20.0
"""So long after its process died a server is still in the graph."""

Answer: TypeAlias = Callable[[Fields], Awaitable[Fields]]

_log = logging.getLogger(__name__)


class FakeMessage(SimpleNamespace):
    """A message with what was given as attributes."""

    def get_fields_and_field_types(self) -> dict[str, str]:
        """Return the names of the fields, as a message of ROS does, without their types."""
        return dict.fromkeys(vars(self), "")


def as_message(fields: Any) -> Any:  # noqa: ANN401  # of any shape, as messages are
    """Return what JSON has as ROS has it: mappings become objects with attributes."""
    if isinstance(fields, Mapping):
        return FakeMessage(**{name: as_message(value) for name, value in fields.items()})
    if isinstance(fields, list | tuple):
        return [as_message(item) for item in fields]
    return fields


def _check_numbers(fields: Any) -> None:  # noqa: ANN401  # of any shape, as messages are
    """Refuse what no message can carry.

    Raises:
        InvalidValueError: An integer is beyond 64 bits.
    """
    if isinstance(fields, Mapping):
        fields = list(fields.values())
    if isinstance(fields, list | tuple):
        for item in fields:
            _check_numbers(item)
    elif isinstance(fields, int) and not -(2**63) <= fields < 2**63:
        raise InvalidValueError(f"{fields} is beyond 64 bits")


@dataclass(frozen=True)
class Request:
    """One request that somebody sent through a client of the graph."""

    at_s: float
    service: str
    fields: Fields


class FakeGraph:
    """A `RosGraph` in memory.

    Args:
        clock: All time that passes is the clock's.
        missing: Types that are not installed; all others are.
    """

    def __init__(self, clock: ManualClock, missing: tuple[str, ...] = ()) -> None:
        self.clock = clock
        self.missing = frozenset(missing)
        self.nodes: dict[str, Lane] = {}
        """Every node of ours, by its full name."""
        self.requests: list[Request] = []
        """Every request that was sent by a client, in order."""
        self.types: dict[str, str] = {}
        """The type of every topic and service that somebody of us named."""
        self.qos: dict[str, Qos] = {}
        """How topics are carried, as the last of us who named one asked for."""
        self.servers: Counter[str] = Counter()
        """How many servers of each service are known."""
        self.drive_outputs: list[FakeDriveOutput] = []
        self.drive_trouble = ""
        """Why new outputs for drive commands do not work at first; empty: they work."""
        """Every output for drive commands."""
        self.faults: list[GraphFault] = []
        """What is wrong in the graph."""
        self.closed = False
        self.actions: dict[str, ActionHandler[Any]] = {}
        """Who drives the goals of each action of ours."""
        self._published: defaultdict[str, list[Fields]] = defaultdict(list)
        self._latched: dict[str, Fields] = {}
        self._listeners: defaultdict[str, list[Callable[[Message], None]]] = defaultdict(list)
        self._liveliness: defaultdict[str, list[Callable[[bool], None]]] = defaultdict(list)
        self._alive: set[str] = set()
        self._servers: dict[str, Answer] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._failed = asyncio.Event()

    # --- the port --------------------------------------------------------------------------------

    def node(self, name: str, lane: Lane) -> "FakeRosNode":
        """Return a new node of ours."""
        assert name not in self.nodes, f"there are two nodes {name}"
        self.nodes[name] = lane
        return FakeRosNode(self)

    def has_type(self, type_name: str) -> bool:
        """Tell whether a type is installed."""
        return type_name not in self.missing

    def require_field(self, type_name: str, path: Sequence[str | int]) -> None:
        """Know every field but one."""
        if "no_such_field" in path:
            raise UnknownFieldError(type_name, "no_such_field", ["data"])

    def drive_output(
        self, topic: str, type_name: str, wheelbase_m: float, owner: str = OWNER
    ) -> "FakeDriveOutput":
        """Return an output that publishes in this graph."""
        self._note(topic, type_name, Qos.COMMANDS)
        output = FakeDriveOutput(self, topic, type_name, wheelbase_m)
        self.drive_outputs.append(output)
        return output

    async def look(self) -> Sequence[GraphFault]:
        """Return what the test set in `faults`."""
        return tuple(self.faults)

    async def wait_failed(self) -> None:
        """Wait until the test calls `fail`."""
        await self._failed.wait()
        raise GraphFailedError("the graph failed")

    async def close(self) -> None:
        """Leave the graph, and end what its nodes are at."""
        self.closed = True
        tasks = [*self._tasks]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    # --- for tests -------------------------------------------------------------------------------

    def publish(self, topic: str, fields: Fields) -> None:
        """Let somebody publish a message; all that listen to the topic hear it now."""
        self._publish(topic, fields, latched=False)

    def published(self, topic: str) -> list[Fields]:
        """Return what was published on a topic, by whomever."""
        return self._published[topic]

    def hear(self, topic: str) -> list[Message]:
        """Let somebody subscribe to a topic; what is returned grows with each message."""
        heard: list[Message] = []
        self._listen(topic, Qos.LATCHED, heard.append)
        return heard

    def leave(self, topic: str) -> None:
        """Let nobody listen to a topic any more."""
        self._listeners.pop(topic, None)

    def is_heard(self, topic: str) -> bool:
        """Tell whether anybody listens to a topic."""
        return bool(self._listeners.get(topic))

    def set_alive(self, topic: str, alive: bool) -> None:
        """Let a topic have one more publisher that lives, or none any more; it is heard at once."""
        if not alive and topic not in self._alive:
            return
        (self._alive.add if alive else self._alive.discard)(topic)
        for take in () if self.closed else self._liveliness[topic]:
            take(alive)

    @property
    def services(self) -> tuple[str, ...]:
        """Return the services that are known in the graph."""
        return tuple(self._servers)

    def offer(self, service: str, answer: Answer) -> None:
        """Let somebody offer a service, in the place of whoever did and is still known."""
        self._servers[service] = answer
        self.servers[service] += 1

    def withdraw(self, service: str) -> None:
        """Let nobody offer a service any more, or nobody that is known."""
        self._servers.pop(service, None)
        self.servers.pop(service, None)

    async def call(self, service: str, request: Fields) -> Fields:
        """Let somebody call a service; what its answer raises is logged, as with ROS.

        Raises:
            KeyError: There is no such service.
        """
        try:
            return await self._servers[service](request)
        except Exception:
            _log.exception("%s failed; the request gets an empty response", service)
            return {}

    def send_goal(self, action: str, goal: Fields) -> "FakeGoal":
        """Let a client send a goal.

        Raises:
            KeyError: There is no such action.
        """
        handler = self.actions[action]
        sent = FakeGoal(handler)
        try:
            read = handler.read(as_message(goal))
        except InvalidValueError as error:
            sent.rejected = str(error)
        else:
            handler.begin(read, sent)
        return sent

    def fail(self) -> None:
        """Let the link to ROS 2 break."""
        self._failed.set()

    def run(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        """Run something until it ends, or until the graph is closed."""
        task = asyncio.create_task(work, name="of a graph in memory")
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)
        return task

    async def pass_time(self, by_s: float) -> None:
        """Wait, in virtual time."""
        await self.clock.sleep_until(self.clock.now() + seconds(by_s))

    # --- for its nodes ---------------------------------------------------------------------------

    def _note(self, name: str, type_name: str, qos: Qos | None = None) -> None:
        if type_name in self.missing:
            raise UnknownTypeError(type_name)
        self.types[name] = type_name
        if qos is not None:
            self.qos[name] = qos

    def _publish(self, topic: str, fields: Fields, latched: bool) -> None:
        self._published[topic].append(fields)
        if latched:
            self._latched[topic] = fields
        if not self.closed:
            for hear in self._listeners[topic]:
                hear(as_message(fields))

    def _listen(self, topic: str, qos: Qos, hear: Callable[[Message], None]) -> None:
        self._listeners[topic].append(hear)
        if qos is Qos.LATCHED and topic in self._latched:
            hear(as_message(self._latched[topic]))

    def _watch(self, topic: str, take: Callable[[bool], None]) -> None:
        self._liveliness[topic].append(take)
        if topic in self._alive:
            take(True)

    async def _ask(self, service: str, request: Fields, within_s: float) -> Message:
        _check_numbers(request)
        self.requests.append(Request(to_seconds(self.clock.now()), service, request))
        response: asyncio.Future[Message] = asyncio.get_running_loop().create_future()
        self.run(self._carry(service, request, response))
        deadline = asyncio.create_task(self.pass_time(within_s))
        try:
            await asyncio.wait({response, deadline}, return_when=asyncio.FIRST_COMPLETED)
            if not response.done():
                raise TimeoutError
            return response.result()
        finally:
            response.cancel()
            deadline.cancel()

    async def _carry(
        self, service: str, request: Fields, response: asyncio.Future[Message]
    ) -> None:
        await self.pass_time(LATENCY_S)
        if service not in self._servers:
            return
        answer = as_message(await self.call(service, request))
        await self.pass_time(LATENCY_S)
        if not response.done():
            response.set_result(answer)


class FakeRosNode:
    """A node of ours in a `FakeGraph`; a `RosNode`."""

    def __init__(self, graph: FakeGraph) -> None:
        self._graph = graph

    def client(self, service: str, type_name: str) -> "FakeClient":
        """Return a client."""
        self._graph._note(service, type_name)  # noqa: SLF001
        return FakeClient(self._graph, service)

    def publisher(self, topic: str, type_name: str, qos: Qos) -> "FakePublisher":
        """Return a publisher."""
        self._graph._note(topic, type_name, qos)  # noqa: SLF001
        return FakePublisher(self._graph, topic, qos)

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        pick: Callable[[Message], PickedT | None],
        take: Callable[[PickedT], None],
    ) -> None:
        """Hear a topic; a message over which `pick` raises is logged and dropped."""

        def hear(message: Message) -> None:
            try:
                picked = pick(message)
            except Exception:
                _log.exception("%s: a message was dropped", topic)
                return
            if picked is not None:
                take(picked)

        self._graph._note(topic, type_name, qos)  # noqa: SLF001
        self._graph._listen(topic, qos, hear)  # noqa: SLF001

    def watch_arrivals(
        self, topic: str, type_name: str, hear: Callable[[int | None], None]
    ) -> None:
        """Hear when somebody publishes, with the stamp of the header, if there is one."""

        def arrive(message: Message) -> None:
            stamp = getattr(getattr(message, "header", None), "stamp", None)
            sec, nanosec = getattr(stamp, "sec", 0), getattr(stamp, "nanosec", 0)
            hear((sec * NANOSECONDS_PER_SECOND + nanosec) or None)

        self._graph._note(topic, type_name, Qos.SENSOR)  # noqa: SLF001
        self._graph._listen(topic, Qos.SENSOR, arrive)  # noqa: SLF001

    def watch_liveliness(
        self, topic: str, type_name: str, lease_s: float, take: Callable[[bool], None]
    ) -> None:
        """Hear whether a topic has a publisher that lives; see `FakeGraph.set_alive`."""
        assert lease_s > 0
        self._graph._note(topic, type_name)  # noqa: SLF001
        self._graph._watch(topic, take)  # noqa: SLF001

    def serve(self, service: str, type_name: str, answer: Answer) -> None:
        """Offer a service; see `FakeGraph.call`."""
        self._graph._note(service, type_name)  # noqa: SLF001
        self._graph.offer(service, answer)

    def serve_action(self, action: str, type_name: str, handler: ActionHandler[GoalT]) -> None:
        """Offer an action; see `FakeGraph.send_goal`."""
        self._graph._note(action, type_name)  # noqa: SLF001
        self._graph.actions[action] = handler


class FakeGoal:
    """A goal that a client sent in a `FakeGraph`; an `AcceptedGoal`."""

    def __init__(self, handler: ActionHandler[Any]) -> None:
        self._handler = handler
        self.rejected = ""
        """Why it was not accepted; empty: it was."""
        self.feedback: list[Fields] = []
        self.ended: tuple[GoalOutcome, Fields] | None = None
        """How it ended, and its result; None: it has not ended."""

    def cancel(self) -> None:
        """Let the client cancel it."""
        self._handler.cancel(self)

    def feed_back(self, feedback: Fields) -> None:
        """Note feedback."""
        self.feedback.append(feedback)

    def end(self, end: GoalOutcome, result: Fields) -> None:
        """Note the end; there is only one."""
        assert self.ended is None, f"it has ended before: {self.ended}"
        self.ended = (end, result)


class FakeClient:
    """A client in a `FakeGraph`; a `Client`."""

    def __init__(self, graph: FakeGraph, service: str) -> None:
        self._graph = graph
        self._service = service

    def is_ready(self) -> bool:
        """Tell whether the graph knows a server."""
        return self._service in self._graph.services

    def servers(self) -> int:
        """Tell how many servers the graph knows."""
        return self._graph.servers[self._service]

    async def call(self, request: Fields, within_s: float) -> Message:
        """Ask, and return the response.

        Raises:
            TimeoutError: There was none in time.
            InvalidValueError: A number is beyond what ROS carries.
        """
        return await self._graph._ask(self._service, request, within_s)  # noqa: SLF001

    async def call_large(self, make: Callable[[], Fields], within_s: float) -> Message:
        """Ask, and return the response.

        Raises:
            TimeoutError: There was none in time.
        """
        return await self.call(make(), within_s)


class FakeDriveOutput:
    """An output for drive commands in a `FakeGraph`; a `DriveOutput`."""

    def __init__(self, graph: FakeGraph, topic: str, type_name: str, wheelbase_m: float) -> None:
        self._graph = graph
        self._topic = topic
        self._type_name = type_name
        self._wheelbase_m = wheelbase_m
        self._deadman = Deadman()
        self.trouble = graph.drive_trouble
        self._changed: Callable[[], None] = lambda: None
        self._alarm = Alarm(self._deadman.wake_at, self._advance, graph.clock)

    def send(self, command: DriveCommand) -> None:
        """Publish a command."""
        self._publish(command)
        self._deadman.take(command, self._graph.clock.now())
        self._alarm.check()

    def fail(self, trouble: str) -> None:
        """Lose commands from now on for this reason, or work again without one."""
        self.trouble = trouble
        self._changed()

    async def run(self, changed: Callable[[], None]) -> None:
        """Command speed 0 when a command expires, until cancelled."""
        self._changed = changed
        try:
            await self._alarm.run()
        finally:
            if self._deadman.wake_at() is not None:
                self._publish(self._deadman.stop())

    def _advance(self) -> None:
        stop = self._deadman.advance(self._graph.clock.now())
        if stop is not None:
            self._publish(stop)

    def _publish(self, command: DriveCommand) -> None:
        clock = self._graph.clock
        now = since_epoch(clock.wall_time(clock.now()))
        message = drive_message(command, self._type_name, self._wheelbase_m, now)
        self._graph._publish(self._topic, message, latched=False)  # noqa: SLF001


class FakePublisher:
    """A publisher in a `FakeGraph`; a `Publisher`."""

    def __init__(self, graph: FakeGraph, topic: str, qos: Qos) -> None:
        self._graph = graph
        self._topic = topic
        self._latched = qos is Qos.LATCHED

    def publish(self, message: Fields) -> None:
        """Send a message."""
        self._graph._publish(self._topic, message, self._latched)  # noqa: SLF001

    def has_subscribers(self) -> bool:
        """Tell whether anybody in the graph listens to the topic."""
        return self._graph.is_heard(self._topic)
