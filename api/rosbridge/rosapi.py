"""The introspection services of rosbridge: `/rosapi/...`.

Only those that clients commonly call, and that can be answered from the offered services and
topics.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import TypeAlias

from api.rosbridge.operations import full_name, is_type
from domain.actor import Actor
from domain.timebase import NANOSECONDS_PER_SECOND
from service.clock import Clock, since_epoch
from service.ros.interface.endpoints import (
    Fields,
    OfferedService,
    OfferedTopic,
    SubscribedTopic,
)
from service.ros.interface.message_check import EMPTY, Kind, Shape, checked

NODE = "rosapi"

Answer: TypeAlias = Callable[[Mapping[str, str]], Fields]

REQUESTS: Mapping[str, Shape] = {
    "GetTime": EMPTY,
    "Nodes": EMPTY,
    "Services": EMPTY,
    "ServiceType": {"service": Kind.TEXT},
    "Topics": EMPTY,
    "TopicsForType": {"type": Kind.TEXT},
    "TopicType": {"topic": Kind.TEXT},
}
"""Fields of requests, by the type of the service without its package."""


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
        own = {
            "get_time": ("GetTime", self._time),
            "nodes": ("Nodes", self._nodes),
            "service_type": ("ServiceType", self._service_type),
            "services": ("Services", self._services),
            "topic_type": ("TopicType", self._topic_type),
            "topics": ("Topics", self._topics),
            "topics_for_type": ("TopicsForType", self._topics_for_type),
        }
        self._clock = clock
        self._types = {topic.name: topic.type for topic in topics}
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
        return {"nodes": sorted({f"/{service.node}" for service in self.services.values()})}

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
