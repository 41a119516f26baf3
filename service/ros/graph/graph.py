"""The port to a ROS 2 graph.

`link.py` implements it with rclpy; the tests have one in memory. All methods and callbacks are
called on the event loop's thread, unless stated otherwise.
"""

from collections.abc import Awaitable, Callable, Mapping, Sequence
from enum import Enum
from typing import Any, Protocol, TypeAlias, TypeVar

from domain.controller import GoalOutcome
from domain.graph_terms import GraphFault
from domain.vehicle import DriveCommand

PickedT = TypeVar("PickedT")
GoalT = TypeVar("GoalT")

OWNER = "pilothouse"
"""The names of the nodes of a service begin with this."""

Fields: TypeAlias = Mapping[str, Any]
"""A message as in JSON: names to numbers, strings, lists and further mappings. Fields that are left
out have their ROS default; a `byte` is a number."""
Message: TypeAlias = Any
"""A ROS message: one attribute per field."""


class UnknownTypeError(Exception):
    """A type of message or service that is not installed on this machine."""

    def __init__(self, type_name: str) -> None:
        package = type_name.partition("/")[0]
        super().__init__(
            f"the ROS 2 type {type_name} is not installed: install its package ({package}) into the"
            " ROS distribution, or source the workspace that has it, before you start Pilothouse"
        )
        self.type_name = type_name


class UnknownFieldError(Exception):
    """A field that no message of a type has."""

    def __init__(self, type_name: str, field: str, known: Sequence[str]) -> None:
        there = f"it has {', '.join(known)}" if known else "it has none"
        super().__init__(f"the ROS 2 type {type_name} has no field {field}; {there}")


class GraphFailedError(Exception):
    """The connection to ROS 2 failed; no more messages are received."""


class Qos(Enum):
    """Quality of service of a topic; both ends must be compatible."""

    EVENTS = "events"
    """Reliable, volatile, depth 100: as lifecycle nodes use it."""
    PARAMETER_EVENTS = "parameter_events"
    """As rclpy and rclcpp publish parameter events."""
    SENSOR = "sensor"
    """Best effort, volatile, depth 5; such a subscription is compatible with every publisher."""
    COMMANDS = "commands"
    """Reliable, volatile, depth 1: an older drive command is void."""
    LATCHED = "latched"
    """Reliable, transient local, depth 1: a late subscriber gets the last message."""


class Lane(Enum):
    """Nodes of ours that share a thread: the callbacks of a lane run one after the other.

    With rclpy the cost of each message grows with the number of entities in its lane. So the
    services of nodes are divided by what is queried of all nodes at the same time, and frequent
    topics are separate from them.
    """

    STATES = "states"
    TRANSITIONS = "transitions"
    PARAMETERS = "parameters"
    LIVELINESS = "liveliness"
    TARGETS = "targets"
    SENSORS = "sensors"
    NAVIGATION = "navigation"
    GATEWAY = "gateway"


class Client(Protocol):
    """A client of a service."""

    def is_ready(self) -> bool:
        """Tell whether the graph knows a server; a dead one remains known for about 20 s."""
        ...

    def servers(self) -> int:
        """Return how many servers the graph knows, including dead ones."""
        ...

    async def call(self, request: Fields, within_s: float) -> Message:
        """Send a request, and return the response.

        Args:
            request: Its fields.
            within_s: Timeout, s.

        Raises:
            TimeoutError: There was no response in time; the fate of the request is unknown.
        """
        ...

    async def call_large(self, make: Callable[[], Fields], within_s: float) -> Message:
        """Send a request of thousands of fields, and return the response.

        To fill and to send it takes a tenth of a second, which is spent on another thread.

        Args:
            make: Returns its fields; called on another thread.
            within_s: Timeout once it was sent, s.

        Raises:
            TimeoutError: There was no response in time; the fate of the request is unknown.
        """
        ...


class Publisher(Protocol):
    """A publisher of a topic."""

    def publish(self, message: Fields) -> None:
        """Publish a message, and return at once.

        An invalid message is logged and not sent. The message must not be changed afterwards.
        """
        ...

    def has_subscribers(self) -> bool:
        """Tell whether the graph knows a subscription that the messages reach."""
        ...


class AcceptedGoal(Protocol):
    """A goal of a client of ours that has not ended."""

    def feed_back(self, feedback: Fields) -> None:
        """Publish feedback, and return at once."""
        ...

    def end(self, end: GoalOutcome, result: Fields) -> None:
        """End the goal with a result, and return at once; call it once.

        `CANCELED` is for a goal whose client asked for that.
        """
        ...


class ActionHandler(Protocol[GoalT]):
    """Drives the goals of an action; several may be there at once."""

    def read(self, message: Message, /) -> GoalT:
        """Return a goal of a client; called on another thread.

        Raises:
            InvalidValueError: The goal cannot be accepted: it is rejected, and that is logged.
        """
        ...

    def begin(self, goal: GoalT, accepted: AcceptedGoal, /) -> None:
        """Begin a goal that was accepted, and return at once."""
        ...

    def cancel(self, accepted: AcceptedGoal, /) -> None:
        """Cancel a goal that may have ended meanwhile, and return at once."""
        ...


class DriveOutput(Protocol):
    """Publishes drive commands.

    A command is valid for 0.5 s: without a new one, speed 0 is commanded then, also while the event
    loop of the service is blocked or its process is dead. That is repeated for 2 s; afterwards, as
    after a command with speed 0, nothing is published, so that another program can drive.
    """

    def send(self, command: DriveCommand) -> None:
        """Publish a command, and return at once."""
        ...

    @property
    def trouble(self) -> str:
        """Return why commands do not reach the topic, and are lost; empty: they reach it."""
        ...

    async def run(self, changed: Callable[[], None]) -> None:
        """Work until cancelled; then command speed 0, unless the vehicle was told to stop.

        Args:
            changed: Called whenever `trouble` changed; must return at once.
        """
        ...


class RosNode(Protocol):
    """One of our own nodes in the graph."""

    def client(self, service: str, type_name: str) -> Client:
        """Return a client; the server need not exist yet.

        Args:
            service: Full name, as `/drive_base/get_state`.
            type_name: As `lifecycle_msgs/srv/GetState`.

        Raises:
            UnknownTypeError: The type is not installed; the other methods raise it as well.
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
        """Subscribe to a topic while the graph is open.

        Args:
            topic: Full name.
            type_name: As `std_msgs/msg/Bool`.
            qos: Requested quality of service.
            pick: Extracts what is needed from a message, on another thread; None: nothing. If it
                raises, that is logged, and the message is dropped.
            take: Called with that on the event loop's thread.
        """
        ...

    def watch_arrivals(
        self, topic: str, type_name: str, hear: Callable[[int | None], None]
    ) -> None:
        """Hear when messages of a topic arrive; of each, no more is read than its time stamp.

        So a topic of large messages costs little more than their transport.

        Args:
            topic: Full name.
            type_name: As `sensor_msgs/msg/PointCloud2`.
            hear: Called on another thread with the time stamp of the message, ns since 1970-01-01
                UTC; None: messages of the type have none, or it is 0.
        """
        ...

    def watch_liveliness(
        self, topic: str, type_name: str, lease_s: float, take: Callable[[bool], None]
    ) -> None:
        """Watch whether a topic has live publishers.

        Only publishers with automatic liveliness and a lease of at most `lease_s` are noticed; they
        need not publish anything.

        Args:
            topic: Full name.
            type_name: As `std_msgs/msg/Empty`.
            lease_s: Liveliness lease, s: the death of a publisher is noticed after this time.
            take: Called when the number of live publishers changes: True if there is one, else
                False.
        """
        ...

    def serve(
        self, service: str, type_name: str, answer: Callable[[Fields], Awaitable[Fields]]
    ) -> None:
        """Offer a service while the graph is open.

        Args:
            service: Full name.
            type_name: As `lifecycle_msgs/srv/ChangeState`.
            answer: Returns the response to a request. It may take long; other requests are
                processed meanwhile. If it raises, that is logged, and the response is empty.
        """
        ...

    def serve_action(self, action: str, type_name: str, handler: ActionHandler[GoalT]) -> None:
        """Offer an action while the graph is open.

        Args:
            action: Full name.
            type_name: As `nav2_msgs/action/FollowPath`.
            handler: Drives its goals.
        """
        ...


class RosGraph(Protocol):
    """The ROS 2 graph."""

    def node(self, name: str, lane: Lane) -> RosNode:
        """Create a node.

        Args:
            name: Full name without the leading slash, as `actuation` or `left/arm`.
            lane: Determines its thread.
        """
        ...

    def has_type(self, type_name: str) -> bool:
        """Tell whether a type of message or service is installed."""
        ...

    def require_field(self, type_name: str, path: Sequence[str | int]) -> None:
        """Check that messages of a type have a field.

        Args:
            type_name: As `sensor_msgs/msg/BatteryState`.
            path: Names of fields, and indices of lists.

        Raises:
            UnknownTypeError: There is no such type.
            UnknownFieldError: It has no such field.
        """
        ...

    def drive_output(
        self, topic: str, type_name: str, wheelbase_m: float, owner: str = OWNER
    ) -> DriveOutput:
        """Return the output for drive commands.

        Args:
            topic: Full name.
            type_name: As `geometry_msgs/msg/Twist`.
            wheelbase_m: Of the vehicle, m.
            owner: The names of its nodes begin with this.

        Raises:
            UnknownTypeError: The type is not installed.
        """
        ...

    async def look(self) -> Sequence[GraphFault]:
        """Look at some of our topics, and return what is known to be wrong in the graph now.

        Each call looks at other topics, so that none is looked at for long. A process that was
        killed stays in the graph for some 20 s.
        """
        ...

    async def wait_failed(self) -> None:
        """Wait until the graph fails; the owner awaits this, so that a failure is not silent.

        Never returns; it is cancelled at the end.

        Raises:
            GraphFailedError: The graph failed.
        """
        ...

    async def close(self) -> None:
        """Leave the graph; afterwards nothing is received or sent."""
        ...
