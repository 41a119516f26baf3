"""The introspection services of rosbridge: `/rosapi/...`.

Those that viewers and client libraries call, as far as they can be answered from the offered
services and topics.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import TypeAlias

from api.rosbridge.definitions import full_text, service_definitions, type_definitions
from api.rosbridge.operations import full_name, is_type
from domain.actor import Actor
from domain.timebase import NANOSECONDS_PER_SECOND
from service.clock import Clock, since_epoch
from service.ros.interface.endpoints import (
    OWN_NODE,
    Fields,
    OfferedService,
    OfferedTopic,
    SubscribedTopic,
)
from service.ros.interface.message_check import EMPTY, Kind, Shape, checked

NODE = "rosapi"

Answer: TypeAlias = Callable[[Mapping[str, str]], Fields]

REQUESTS: Mapping[str, Shape] = {
    "GetActionServers": EMPTY,
    "GetParamNames": EMPTY,
    "GetROSVersion": EMPTY,
    "GetTime": EMPTY,
    "MessageDetails": {"type": Kind.TEXT},
    "NodeDetails": {"node": Kind.TEXT},
    "Nodes": EMPTY,
    "Publishers": {"topic": Kind.TEXT},
    "ServiceNode": {"service": Kind.TEXT},
    "ServiceProviders": {"service": Kind.TEXT},
    "ServiceRequestDetails": {"type": Kind.TEXT},
    "ServiceResponseDetails": {"type": Kind.TEXT},
    "ServiceType": {"service": Kind.TEXT},
    "Services": EMPTY,
    "ServicesForType": {"type": Kind.TEXT},
    "Subscribers": {"topic": Kind.TEXT},
    "TopicType": {"topic": Kind.TEXT},
    "Topics": EMPTY,
    "TopicsAndRawTypes": EMPTY,
    "TopicsForType": {"type": Kind.TEXT},
}
"""Fields of requests, by the type of the service without its package."""

_ROS_VERSION = 2


class RosApi:
    """Answers questions about the offered services and topics."""

    def __init__(
        self,
        services: Mapping[str, OfferedService],
        topics: Iterable[OfferedTopic | SubscribedTopic],
        clock: Clock,
    ) -> None:
        """Prepare.

        Args:
            services: By full name, without those of rosapi.
            topics: All topics, published and subscribed.
            clock: Of the robot.
        """
        own: Mapping[str, tuple[str, Answer]] = {
            "action_servers": ("GetActionServers", lambda _: {"action_servers": []}),
            "get_param_names": ("GetParamNames", lambda _: {"names": []}),
            "get_ros_version": ("GetROSVersion", lambda _: {"version": _ROS_VERSION, "distro": ""}),
            "get_time": ("GetTime", self._time),
            "message_details": ("MessageDetails", _message_details),
            "node_details": ("NodeDetails", self._node_details),
            "nodes": ("Nodes", self._nodes),
            "publishers": ("Publishers", self._publishers),
            "service_node": ("ServiceNode", self._service_node),
            "service_providers": ("ServiceProviders", self._service_providers),
            "service_request_details": ("ServiceRequestDetails", _request_details),
            "service_response_details": ("ServiceResponseDetails", _response_details),
            "service_type": ("ServiceType", self._service_type),
            "services": ("Services", self._services),
            "services_for_type": ("ServicesForType", self._services_for_type),
            "subscribers": ("Subscribers", self._subscribers),
            "topic_type": ("TopicType", self._topic_type),
            "topics": ("Topics", self._topics),
            "topics_and_raw_types": ("TopicsAndRawTypes", self._topics_and_raw_types),
            "topics_for_type": ("TopicsForType", self._topics_for_type),
        }
        self._topics_by_name = {topic.name: topic for topic in topics}
        self._clock = clock
        self._types = {name: topic.type for name, topic in self._topics_by_name.items()}
        self.services: Mapping[str, OfferedService] = {
            **services,
            **{
                f"/{NODE}/{name}": _service(name, type_name, answer)
                for name, (type_name, answer) in own.items()
            },
        }
        """All services, including those of rosapi, by full name."""

    def _time(self, request: Mapping[str, str]) -> Fields:
        now = since_epoch(self._clock.wall_time(self._clock.now()))
        sec, nanosec = divmod(now, NANOSECONDS_PER_SECOND)
        # Some clients read the fields of ROS 2, others still those of ROS 1.
        return {"time": {"sec": sec, "nanosec": nanosec, "secs": sec, "nsecs": nanosec}}

    def _nodes(self, request: Mapping[str, str]) -> Fields:
        offered = (t for t in self._topics_by_name.values() if isinstance(t, OfferedTopic))
        nodes = {service.node for service in self.services.values()} | {t.node for t in offered}
        return {"nodes": sorted(f"/{node}" for node in nodes)}

    def _services(self, request: Mapping[str, str]) -> Fields:
        return {"services": [*self.services]}

    def _service_type(self, request: Mapping[str, str]) -> Fields:
        found = self.services.get(full_name(request["service"]))
        return {"type": found.type if found else ""}

    def _topics(self, request: Mapping[str, str]) -> Fields:
        return {"topics": [*self._types], "types": [*self._types.values()]}

    def _topic_type(self, request: Mapping[str, str]) -> Fields:
        return {"type": self._types.get(full_name(request["topic"]), "")}

    def _topics_for_type(self, request: Mapping[str, str]) -> Fields:
        asked = request["type"]
        found = [name for name, known in self._types.items() if asked and is_type(asked, known)]
        return {"topics": found}

    def _topics_and_raw_types(self, request: Mapping[str, str]) -> Fields:
        texts = {type_name: full_text(type_name) for type_name in {*self._types.values()}}
        shown = [texts[type_name] for type_name in self._types.values()]
        return {**self._topics(request), "typedefs_full_text": shown}

    def _services_for_type(self, request: Mapping[str, str]) -> Fields:
        asked = request["type"]
        known = self.services.values()
        return {"services": [s.name for s in known if asked and is_type(asked, s.type)]}

    def _service_node(self, request: Mapping[str, str]) -> Fields:
        found = self.services.get(full_name(request["service"]))
        return {"node": f"/{found.node}" if found else ""}

    def _service_providers(self, request: Mapping[str, str]) -> Fields:
        """Return the nodes with a service; its type may be given instead, as some clients do."""
        asked = request["service"]
        found = [
            f"/{service.node}"
            for service in self.services.values()
            if asked and (service.name == full_name(asked) or is_type(asked, service.type))
        ]
        return {"providers": [*dict.fromkeys(found)]}

    def _publishers(self, request: Mapping[str, str]) -> Fields:
        topic = self._topics_by_name.get(full_name(request["topic"]))
        return {"publishers": [f"/{topic.node}"] if isinstance(topic, OfferedTopic) else []}

    def _subscribers(self, request: Mapping[str, str]) -> Fields:
        topic = self._topics_by_name.get(full_name(request["topic"]))
        is_heard = isinstance(topic, SubscribedTopic)
        return {"subscribers": [f"/{OWN_NODE}"] if is_heard else []}

    def _node_details(self, request: Mapping[str, str]) -> Fields:
        node = request["node"].removeprefix("/")
        publishing, subscribing = [], []
        for topic in self._topics_by_name.values():
            if isinstance(topic, SubscribedTopic):
                subscribing += [topic.name] * (node == OWN_NODE)
            elif topic.node == node:
                publishing.append(topic.name)
        services = [service.name for service in self.services.values() if service.node == node]
        return {"subscribing": subscribing, "publishing": publishing, "services": services}


def _message_details(request: Mapping[str, str]) -> Fields:
    return {"typedefs": type_definitions(request["type"])}


def _request_details(request: Mapping[str, str]) -> Fields:
    return {"typedefs": service_definitions(request["type"], of_response=False)}


def _response_details(request: Mapping[str, str]) -> Fields:
    return {"typedefs": service_definitions(request["type"], of_response=True)}


def _service(name: str, type_name: str, answer: Answer) -> OfferedService:
    async def call(request: Fields, caller: Actor) -> Fields:
        return answer(checked(REQUESTS[type_name], request))

    return OfferedService(
        name=f"/{NODE}/{name}",
        type=f"rosapi_msgs/srv/{type_name}",
        node=NODE,
        of_a_node=False,
        call=call,
    )
