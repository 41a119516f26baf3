"""What we need of a ROS 2 graph, and nothing about who provides it.

`link.py` provides it with rclpy; the tests have one in memory. All is called on the event loop's
thread, and all that comes back comes there.
"""

from collections.abc import Awaitable, Callable, Mapping, Sequence
from enum import Enum
from typing import Any, Protocol, TypeAlias, TypeVar

PickedT = TypeVar("PickedT")

Fields: TypeAlias = Mapping[str, Any]
"""A message as JSON has it: names to numbers, strings, lists and further mappings. What is left out
has the value that ROS gives it; a `byte` is a number."""
Message: TypeAlias = Any
"""A message as ROS has it: one attribute per field."""


class UnknownTypeError(Exception):
    """A type of message or service that is not installed on this machine."""

    def __init__(self, type_name: str) -> None:
        package = type_name.partition("/")[0]
        super().__init__(
            f"the ROS 2 type {type_name} is not there: install its package ({package}) into the ROS"
            " distribution, or source the workspace that has it, before Pilothouse is started"
        )
        self.type_name = type_name


class UnknownFieldError(Exception):
    """A field that no message of a type has."""

    def __init__(self, type_name: str, field: str, known: Sequence[str]) -> None:
        there = f"it has {', '.join(known)}" if known else "it has none"
        super().__init__(f"the ROS 2 type {type_name} has no field {field}; {there}")


class GraphFailedError(Exception):
    """What carries messages between us and ROS 2 broke; nothing of it is heard any more."""


class Qos(Enum):
    """How messages of a topic are carried; both ends must agree."""

    EVENTS = "events"
    """Reliable, the last 100, nothing for late comers: what lifecycle nodes use."""
    PARAMETER_EVENTS = "parameter_events"
    """As rclpy and rclcpp publish them."""
    SENSOR = "sensor"
    """The last 5, and lost ones stay lost; a subscription like this hears every publisher."""
    COMMANDS = "commands"
    """Reliable, only the last one, nothing for late comers: an older command to drive is void."""
    LATCHED = "latched"
    """Reliable, and the last one is kept for late comers."""


class Lane(Enum):
    """Which nodes share a thread: the callbacks of a lane run one after the other.

    With rclpy each message costs as much as the lane has things to wait for. So the many services
    of nodes are divided by what is asked of all of them at the same time, and what comes often is
    kept apart from them.
    """

    STATES = "states"
    TRANSITIONS = "transitions"
    PARAMETERS = "parameters"
    LIVELINESS = "liveliness"
    SENSORS = "sensors"
    GATEWAY = "gateway"


class Client(Protocol):
    """One service of somebody else."""

    def is_ready(self) -> bool:
        """Tell whether the graph knows a server; one that died is known for some 20 s more."""
        ...

    def servers(self) -> int:
        """Tell how many servers the graph knows, the dead ones included."""
        ...

    async def call(self, request: Fields, within_s: float) -> Message:
        """Ask, and return the response.

        Raises:
            TimeoutError: There was none in time; nothing is known of what became of the request.
        """
        ...


class Publisher(Protocol):
    """One topic of ours."""

    def publish(self, message: Fields) -> None:
        """Send a message, and return at once.

        One that the type cannot hold is logged and not sent. The message must not be changed
        afterwards.
        """
        ...


class RosNode(Protocol):
    """One node of ours, as others see it in the graph."""

    def client(self, service: str, type_name: str) -> Client:
        """Return a client; there need be no server yet.

        Args:
            service: Full name, as `/drive_base/get_state`.
            type_name: As `lifecycle_msgs/srv/GetState`.

        Raises:
            UnknownTypeError: There is no such type on this machine. The other methods as well.
        """
        ...

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Return a publisher."""
        ...

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        pick: Callable[[Message], PickedT | None],
        take: Callable[[PickedT], None],
    ) -> None:
        """Hear a topic for as long as the graph is open.

        Args:
            topic: Full name.
            type_name: As `std_msgs/msg/Bool`.
            qos: What is asked of its publishers.
            pick: Takes out of a message what matters, on another thread; None: nothing does. What
                it raises is logged, and the message is dropped.
            take: Is handed that, on the event loop's thread.
        """
        ...

    def watch_liveliness(
        self, topic: str, type_name: str, lease_s: float, take: Callable[[bool], None]
    ) -> None:
        """Hear which publishers of a topic live.

        Only publishers with automatic liveliness and a lease as short or shorter are noticed; none
        has to publish anything.

        Args:
            topic: Full name.
            type_name: As `std_msgs/msg/Empty`.
            lease_s: How long after its process died a publisher is missed, in seconds.
            take: Is handed True whenever one comes or goes and there is one then, and False once
                there is none any more.
        """
        ...

    def serve(
        self, service: str, type_name: str, answer: Callable[[Fields], Awaitable[Fields]]
    ) -> None:
        """Offer a service for as long as the graph is open.

        Args:
            service: Full name.
            type_name: As `lifecycle_msgs/srv/ChangeState`.
            answer: Returns the response to a request, and may take its time: others are served
                meanwhile. What it raises is logged, and the request gets an empty response.
        """
        ...


class RosGraph(Protocol):
    """The ROS 2 graph that we are part of."""

    def node(self, name: str, lane: Lane) -> RosNode:
        """Return a new node of ours.

        Args:
            name: Full name without the leading slash, as `actuation` or `left/arm`.
            lane: Which nodes it shares a thread with.
        """
        ...

    def has_type(self, type_name: str) -> bool:
        """Tell whether a type of message or service is installed."""
        ...

    def require_field(self, type_name: str, path: Sequence[str | int]) -> None:
        """See that messages of a type have a field.

        Args:
            type_name: As `sensor_msgs/msg/BatteryState`.
            path: Names of fields, and places in lists.

        Raises:
            UnknownTypeError: There is no such type.
            UnknownFieldError: It has no such field.
        """
        ...

    async def wait_failed(self) -> None:
        """Wait until the graph fails; whoever runs us awaits this, so that it is not silent.

        Raises:
            GraphFailedError: It has. This never returns, and is cancelled if all goes well.
        """
        ...

    async def close(self) -> None:
        """Leave the graph; nothing is heard afterwards, and nothing can be sent."""
        ...
