"""Offers the services and topics of `RosInterface` in a ROS 2 graph.

Each system appears as a ROS node of its name, so that tools for lifecycle nodes find it; everything
else belongs to the node `pilothouse`.
"""

import asyncio
import logging
from collections.abc import Callable, Collection
from contextlib import suppress
from functools import partial

from domain.actor import Actor
from domain.errors import PilothouseError
from domain.timebase import seconds
from service.clock import Clock
from service.ros.graph.conversion import fields_of
from service.ros.graph.graph import Fields, Lane, Publisher, Qos, RosGraph, RosNode
from service.ros.graph.names import is_allowed
from service.ros.interface.endpoints import OWN_NODE, OfferedService, OfferedTopic, SubscribedTopic
from service.ros.interface.fallback_types import (
    SERVICE_FALLBACKS,
    TOPIC_FALLBACKS,
    Convert,
    ServiceFallback,
    TopicFallback,
)
from service.ros.interface.interface import RosInterface
from service.ros.interface.message_sets import MessageSet
from service.ros.offered import OfferedNames

log = logging.getLogger(__name__)

CALLER = Actor("ros")
"""Recorded as the caller or sender, since ROS does not identify it."""

_LOOK_EVERY = seconds(0.5)


class RosGateway:
    """Offers an interface in a graph."""

    def __init__(
        self,
        interface: RosInterface,
        graph: RosGraph,
        clock: Clock,
        mapped_topics: Collection[str] = (),
    ) -> None:
        """Prepare.

        Args:
            interface: The services and topics.
            graph: The ROS 2 graph.
            clock: Of the service.
            mapped_topics: Full names of topics that the robot file maps to signals; the backend
                subscribes to them, and so the gateway does not.
        """
        self._interface = interface
        self._graph = graph
        self._clock = clock
        self._mapped_topics = mapped_topics
        self._nodes: dict[str, RosNode] = {}
        self._on_demand: dict[str, tuple[Publisher, Convert]] = {}
        """Topics that are listened to only while somebody subscribes."""
        self._missing_types: set[str] = set()
        self._unheard_types: set[str] = set()
        self._odd_names: set[str] = set()
        self._offered = OfferedNames()

    async def offer(self) -> None:
        """Create the nodes, services and topics.

        Other tasks of the event loop run in between, since a hundred parts take a second.

        If a type is not installed, a standard type takes its place (`interface.fallback_types`).
        Services and topics without one, and those whose name ROS does not allow, are left out; the
        log names them, and lists what is offered.
        """
        for service in self._interface.services.values():
            if not service.of_a_node and self._is_allowed(service.name):
                self._serve(service)
                await asyncio.sleep(0)
        for topic in self._interface.topics.values():
            if not topic.of_a_node and self._is_allowed(topic.name):
                self._publish(topic)
                await asyncio.sleep(0)
        for heard in self._interface.heard.values():
            if heard.name not in self._mapped_topics:
                self._hear(heard)
        if self._odd_names:
            names = ", ".join(sorted(self._odd_names))
            log.warning("not offered in ROS 2, since these names are not allowed: %s", names)
        _tell_missing("offered", self._missing_types)
        _tell_missing("subscribed to", self._unheard_types)
        for line in self._offered.lines(self._interface.parts):
            log.info("ROS 2 %s", line)

    async def run(self) -> None:
        """Publish messages about events and states, until cancelled."""
        async with asyncio.TaskGroup() as group:
            group.create_task(self._listen_on_demand(), name="topics on demand")
            await self._interface.run()

    async def _listen_on_demand(self) -> None:
        """Listen to each of the topics on demand while somebody subscribes to it."""
        stops: dict[str, Callable[[], None]] = {}
        while True:
            for topic, (publisher, convert) in self._on_demand.items():
                is_heard = publisher.has_subscribers()
                if is_heard and topic not in stops:
                    take = partial(_send, publisher, convert)
                    stops[topic] = self._interface.listen(topic, take)
                elif not is_heard and topic in stops:
                    stops.pop(topic)()
            await self._clock.sleep_until(self._clock.now() + _LOOK_EVERY)

    def _serve(self, service: OfferedService) -> None:
        carrier = SERVICE_FALLBACKS.get(service.type)
        type_name, answer = service.type, partial(_answer, service)
        if carrier is not None and not self._graph.has_type(type_name):
            type_name, answer = carrier.type, partial(_answer_carried, service, carrier)
        if not self._graph.has_type(type_name):
            self._missing_types.add(service.type)
            return
        self._node(service.node).serve(service.name, type_name, answer)
        self._offered.services[service.name] = type_name

    def _publish(self, topic: OfferedTopic) -> None:
        carrier = TOPIC_FALLBACKS.get(topic.type)
        if self._graph.has_type(topic.type):
            carrier = TopicFallback(topic.type, _as_it_is)
        if carrier is None or not self._graph.has_type(carrier.type):
            self._missing_types.add(topic.type)
            return
        qos = Qos.LATCHED if topic.latched else Qos.EVENTS
        publisher = self._node(topic.node).publisher(topic.name, carrier.type, qos)
        self._offered.published[topic.name] = carrier.type
        if topic.on_demand:
            self._on_demand[topic.name] = (publisher, carrier.message)
        else:
            self._interface.listen(topic.name, partial(_send, publisher, carrier.message))

    def _hear(self, heard: SubscribedTopic) -> None:
        if not self._graph.has_type(heard.type):
            self._unheard_types.add(heard.type)
            return
        take = partial(self._take, heard)
        qos = Qos.EVENTS if heard.needs_all else Qos.SENSOR
        self._node(OWN_NODE).subscribe(heard.name, heard.type, qos, fields_of, take)
        self._offered.subscribed[heard.name] = heard.type

    def _take(self, heard: SubscribedTopic, message: Fields) -> None:
        """Submit a message; a rejected one, which is logged, must not end the subscription."""
        with suppress(PilothouseError):
            heard.take(message, CALLER)

    def _node(self, name: str) -> RosNode:
        if name not in self._nodes:
            self._nodes[name] = self._graph.node(name, Lane.GATEWAY)
        return self._nodes[name]

    def _is_allowed(self, name: str) -> bool:
        """Tell whether ROS allows a name; models may have others."""
        allowed = is_allowed(name)
        if not allowed:
            self._odd_names.add(name.rpartition("/")[0])
        return allowed


def _tell_missing(what: str, types: Collection[str]) -> None:
    """Log which types are not installed; our own ones are to be built, and often are not."""
    own = {name for name in types if name.startswith(f"{MessageSet.PILOTHOUSE}/")}
    for level, found in ((logging.INFO, own), (logging.WARNING, {*types} - own)):
        if found:
            listed = ", ".join(sorted(found))
            message = "not %s in ROS 2, since these types are not installed: %s"
            log.log(level, message, what, listed)


def _as_it_is(message: Fields) -> Fields:
    return message


async def _answer(service: OfferedService, request: Fields) -> Fields:
    return await service.call(request, CALLER)


async def _answer_carried(
    service: OfferedService, carrier: ServiceFallback, request: Fields
) -> Fields:
    return carrier.response(await service.call(carrier.request(request), CALLER))


def _send(publisher: Publisher, convert: Convert, message: Fields) -> None:
    publisher.publish(convert(message))
