"""The subscriptions and calls of one rosbridge client, without any network code."""

import asyncio
from collections.abc import Callable, Coroutine, Mapping
from types import MappingProxyType
from typing import Any, TypeAlias

from api.http.access import ReadsOnlyError
from api.http.stop_asked import StopTakenError, is_stop_of_rosbridge, members_of
from api.rosbridge.bridge import Bridge, request_of
from api.rosbridge.operations import (
    Advertise,
    Authenticate,
    CallService,
    Operation,
    Publish,
    SetLevel,
    Subscribe,
    Unadvertise,
    Unsubscribe,
    full_name,
    id_of,
    is_type,
    read_message,
    read_operation,
)
from api.rosbridge.replies import response_text, sentence, status_text
from api.rosbridge.send_queue import SendQueue
from api.rosbridge.subscription import Pace, Subscription
from domain.actor import Actor
from domain.errors import InvalidValueError, PilothouseError, UnknownNameError
from domain.health.signals import ESTOP_SIGNAL
from domain.timebase import seconds
from service.ros.interface.endpoints import OfferedService
from service.ros.interface.reading_topics import asks_for_stop_by_fields

MAX_CALLS = 16
"""Pending calls of one client."""
MAX_SUBSCRIPTIONS = 1_000
MAX_CALL_S = 120.0
"""Timeout of a call, s; each service has a shorter deadline of its own."""
_MAX_PUBLISHED = 1_000

_LEVELS: Mapping[str, int] = MappingProxyType({"none": 0, "error": 1, "warning": 2, "info": 3})

Spawn: TypeAlias = Callable[[Coroutine[Any, Any, None]], asyncio.Task[None]]


class Session:
    """One client."""

    def __init__(
        self,
        bridge: Bridge,
        queue: SendQueue,
        caller: Actor,
        spawn: Spawn,
        *,
        reads_only: bool = False,
    ) -> None:
        """Prepare.

        Args:
            bridge: Shared by all clients.
            queue: Takes messages to the client.
            caller: The client, as recorded in events.
            spawn: Runs a call as a task, and owns it.
            reads_only: Whether it may only subscribe, and ask what there is.
        """
        self._reads_only = reads_only
        self._bridge = bridge
        self._queue = queue
        self._caller = caller
        self._spawn = spawn
        self._level = _LEVELS["warning"]
        self._subscriptions: dict[str, tuple[Subscription, Callable[[], None]]] = {}
        """By the name that the client uses, with a function that ends the subscription."""
        self._wishes = 0
        """Number of `subscribe` operations in force."""
        self._published: set[str] = set()
        """Topics that the client advertised or published to, also those without a subscriber."""
        self._calls: set[asyncio.Task[None]] = set()
        self._calls_left: int | None = None
        """Calls still allowed after the client disconnected; None: it is connected."""

    def hear(self, message: Mapping[str, Any], *, overtaken: bool = False) -> None:
        """Process a message; if it is invalid, an error status is queued.

        Args:
            message: An ASGI message of the client.
            overtaken: A later message that asks for a stop was processed before this one, which
                therefore must not release it.
        """
        try:
            operation = read_operation(read_message(message))
        except PilothouseError as error:
            self._hear_unreadable(message, error)
            return
        try:
            self._do(operation, overtaken=overtaken)
        except PilothouseError as error:
            if isinstance(operation, CallService):
                self._respond(operation, sentence(error), result=False)
            else:
                self._tell("error", sentence(error), operation.id)

    def leave(self) -> None:
        """Note that the client disconnected while some of its messages are still queued.

        Their readings are accepted, but at most `MAX_CALLS` calls are started: a flood of calls
        would keep the robot busy for minutes after its sender was stopped.
        """
        if self._calls_left is None:
            self._calls_left = MAX_CALLS

    def end(self) -> None:
        """End all subscriptions, and cancel the calls."""
        for _, unlisten in self._subscriptions.values():
            unlisten()
        self._subscriptions.clear()
        for call in self._calls:
            call.cancel()

    def _hear_unreadable(self, message: Mapping[str, Any], error: PilothouseError) -> None:
        """Take the stop that an invalid message asks for, or say what is wrong with it."""
        said = members_of(message)
        if is_stop_of_rosbridge(message) and not self._reads_only:
            self._bridge.interface.heard[f"/{ESTOP_SIGNAL}"].take({"enabled": True}, self._caller)
            self._bridge.refused.note_ignored(self._caller, error.message)
            self._tell("warning", StopTakenError(error).message, id_of(said))
            return
        if said.get("op") == "publish":
            self._bridge.refused.note(self._caller, error.message)
        if said.get("op") == "call_service":
            service = said.get("service")
            named = service if isinstance(service, str) else ""
            self._queue.put(response_text(named, sentence(error), False, id_of(said)))
        else:
            self._tell("error", sentence(error), id_of(said))

    def _do(self, operation: Operation, *, overtaken: bool) -> None:
        if self._reads_only and _writes(operation):
            raise ReadsOnlyError
        match operation:
            case Subscribe():
                self._subscribe(operation)
            case Unsubscribe():
                self._unsubscribe(operation)
            case Advertise():
                self._advertise(operation)
            case Unadvertise():
                self._unadvertise(operation)
            case Publish():
                self._publish(operation, overtaken=overtaken)
            case CallService():
                self._call(operation)
            case SetLevel():
                self._level = _LEVELS[operation.level]
            case Authenticate():
                # The client has access already; one that has a token sends it anyway.
                pass

    def _tell(self, level: str, message: str, id_: str | int | None) -> None:
        if _LEVELS[level] <= self._level:
            self._queue.put(status_text(level, message, id_))

    # --- topics ----------------------------------------------------------------------------------

    def _subscribe(self, asked: Subscribe) -> None:
        name = full_name(asked.topic)
        topic = self._bridge.interface.topics.get(name)
        if topic is None:
            if name in self._bridge.interface.heard:
                raise InvalidValueError(f"{name} can only be published to", "/topic")
            raise UnknownNameError("topic", name, (), "/rosapi/topics lists what there is")
        if not is_type(asked.type, topic.type):
            raise InvalidValueError(f"{name} is {topic.type}, not {asked.type!r:.100}", "/type")
        if self._wishes >= MAX_SUBSCRIPTIONS:
            raise InvalidValueError(f"too many subscriptions: at most {MAX_SUBSCRIPTIONS}")
        if asked.compression not in (None, "", "none"):
            message = f"{name} is sent without compression {asked.compression!r:.40}"
            self._tell("warning", message, asked.id)
        if asked.fragment_size is not None:
            self._tell("warning", f"{name} is sent in whole messages", asked.id)
        pace = Pace(seconds(asked.throttle_rate / 1_000), asked.queue_length)
        known = self._subscriptions.get(asked.topic)
        if known is not None:
            self._wishes += known[0].want(asked.id, pace)
            return
        queue = self._queue
        texts = self._bridge.texts
        subscription = Subscription(topic, asked.topic, texts, queue.put, queue.expect)
        self._wishes += subscription.want(asked.id, pace)
        unlisten = self._bridge.interface.listen(name, subscription.hear)
        self._subscriptions[asked.topic] = subscription, unlisten

    def _unsubscribe(self, asked: Unsubscribe) -> None:
        known = self._subscriptions.get(asked.topic)
        ended = known[0].unwant(asked.id) if known else 0
        if known is None or not ended:
            self._tell("warning", f"{asked.topic} is not subscribed to by this id", asked.id)
            return
        self._wishes -= ended
        subscription, unlisten = known
        if not subscription.is_wanted:
            unlisten()
            self._queue.remove(subscription)
            del self._subscriptions[asked.topic]

    def _advertise(self, asked: Advertise) -> None:
        name = full_name(asked.topic)
        self._remember_published(name)
        topic = self._bridge.interface.heard.get(name)
        if topic is None:
            raise _unheard(name)
        if not is_type(asked.type, topic.type):
            raise InvalidValueError(f"{name} is {topic.type}, not {asked.type!r:.100}", "/type")

    def _unadvertise(self, asked: Unadvertise) -> None:
        name = full_name(asked.topic)
        if name not in self._published:
            self._tell("warning", f"{name} was not advertised", asked.id)
        self._published.discard(name)

    def _publish(self, asked: Publish, *, overtaken: bool) -> None:
        name = full_name(asked.topic)
        topic = self._bridge.interface.heard.get(name)
        if topic is not None:
            is_void = overtaken and name == f"/{ESTOP_SIGNAL}"
            if is_void and not asks_for_stop_by_fields(asked.msg):
                return
            ignored = topic.take(asked.msg, self._caller)
            if ignored is not None:
                self._tell("warning", f"the stop was taken; ignored: {ignored}", asked.id)
        elif name not in self._published:
            # Reported once: a client may publish many times a second.
            self._remember_published(name)
            raise _unheard(name)

    def _remember_published(self, name: str) -> None:
        if len(self._published) >= _MAX_PUBLISHED:
            self._published.clear()
        self._published.add(name)

    # --- services --------------------------------------------------------------------------------

    def _call(self, asked: CallService) -> None:
        if self._calls_left is not None:
            self._calls_left -= 1
            if self._calls_left < 0:
                return
        service = self._bridge.services.get(full_name(asked.service))
        if service is None:
            self._respond(asked, f"there is no service {full_name(asked.service)}", result=False)
        elif len(self._calls) >= MAX_CALLS:
            self._respond(asked, f"too many pending calls: at most {MAX_CALLS}", result=False)
        elif not self._bridge.may_call(service.name, self._caller):
            allowed = f"{self._bridge.calls_per_s} calls a second"
            self._respond(asked, f"more than {allowed} came from this address", result=False)
        else:
            call = self._spawn(self._finish(asked, service))
            self._calls.add(call)
            call.add_done_callback(self._calls.discard)

    async def _finish(self, asked: CallService, service: OfferedService) -> None:
        """Call a service, and send its response."""
        limit = asked.timeout if asked.timeout is not None and asked.timeout > 0 else MAX_CALL_S
        limit = min(limit, MAX_CALL_S)
        try:
            request = request_of(service.type, asked.args)
            async with asyncio.timeout(limit):
                values = await service.call(request, self._caller)
        except PilothouseError as error:
            self._respond(asked, sentence(error), result=False)
        except TimeoutError:
            message = f"{service.name} did not answer within {limit:g} s"
            self._respond(asked, message, result=False)
        else:
            self._respond(asked, values, result=True)

    def _respond(
        self, asked: CallService, values: Mapping[str, Any] | str, *, result: bool
    ) -> None:
        self._queue.put(response_text(asked.service, values, result, asked.id))


def _unheard(name: str) -> UnknownNameError:
    hint = "messages on it are discarded; only topics of signals have a subscriber"
    return UnknownNameError("subscriber of", name, (), hint)


def _writes(operation: Operation) -> bool:
    """Tell whether an operation may change something: all but subscribing and `/rosapi`."""
    if isinstance(operation, CallService):
        return not full_name(operation.service).startswith("/rosapi/")
    return isinstance(operation, Publish | Advertise)
