"""The ROS 2 graph through rclpy; the only module that imports it.

Each lane has an rclpy executor that spins in a thread of its own. Received messages reach the event
loop through a `Crossing`. In the other direction, requests are sent directly from the loop, which
rclpy allows. Responses are sent by the lane, since the middleware may block
while a client is joining or leaving; all other messages are published by a `Sender`.
"""

import asyncio
import logging
import sys
import threading
import time
from collections.abc import Awaitable, Callable, Sequence
from typing import Any

import rclpy
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.exceptions import NoTypeSupportImportedException
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSCompatibility,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
    qos_profile_parameter_events,
)
from rclpy.signals import SignalHandlerOptions
from rclpy.type_support import check_for_type_support
from rosidl_generator_py.import_type_support_impl import UnsupportedTypeSupport

from domain.graph_terms import GraphFault
from domain.vehicle import DriveCommand
from service.call_thread import CallThread
from service.ros.graph.action_goals import ActionGoals
from service.ros.graph.conversion import find_type, require_field
from service.ros.graph.crossing import MAX_UNANSWERED, Crossing, Inbox, Server
from service.ros.graph.domain_id import check_domain
from service.ros.graph.drive import drive_message
from service.ros.graph.drive_process import DriveProcess
from service.ros.graph.ends import Drain, LinkPublisher
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
    UnknownTypeError,
)
from service.ros.graph.header import begins_with_header, stamp_in
from service.ros.graph.sending import Sender, Turnstile
from service.ros.graph.service_client import ServiceClient
from service.ros.graph.survey import End, Survey

_PROFILES = {
    Qos.EVENTS: QoSProfile(depth=100),
    Qos.PARAMETER_EVENTS: qos_profile_parameter_events,
    Qos.SENSOR: QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT),
    Qos.COMMANDS: QoSProfile(depth=1),
    Qos.LATCHED: QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
}
# By default only 10 requests may come at once; further ones are lost silently.
_SERVING = QoSProfile(depth=2 * MAX_UNANSWERED)
# Each event handler slows down every wait of a lane.
_NO_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
_NO_PUBLISHER_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)
_GOALS = {True: GoalResponse.ACCEPT, False: GoalResponse.REJECT}
_CANCELS = {True: CancelResponse.ACCEPT, False: CancelResponse.REJECT}
_LIVELINESS_DEPTH = 8
_ARRIVALS_DEPTH = 5
_LOOK_S = 1.0
"""Time between two looks at the publishers of a topic whose messages are counted."""
_JOIN_S = 1.0
_LEAVE_S = 3.0
_SWITCH_S = 0.0005
"""For how long a lane may keep the interpreter from the event loop; by default it is 5 ms, each."""
_URGENT = frozenset({Lane.SENSORS, Lane.GATEWAY})
"""Lanes of which no message waits for others: the emergency stop comes on them."""
_GATHER_S = 0.003
"""How long each other lane gathers messages while they keep coming."""
_REQUESTS_AT_ONCE = 2
"""Per pass of the event loop; one request takes 0.1 to 0.5 ms."""

_log = logging.getLogger(__name__)


class RosLink:
    """A `RosGraph` through rclpy.

    Domain and discovery are configured by the environment, as in every ROS program.
    """

    def __init__(self) -> None:
        """Join the graph; an event loop is not needed before the first node.

        Raises:
            RuntimeError: The middleware does not start, or ROS_DOMAIN_ID is invalid.
        """
        check_domain()
        sys.setswitchinterval(min(_SWITCH_S, sys.getswitchinterval()))
        self.context = rclpy.Context()
        # No arguments, since those of the command line are not for ROS; no signal handlers, since
        # `pilothouse serve` handles SIGTERM and SIGINT.
        rclpy.init(args=[], context=self.context, signal_handler_options=SignalHandlerOptions.NO)
        self.crossing = Crossing()
        """Passes messages to the event loop; once it is closed, nothing is sent any more either."""
        self.sender = Sender()
        self.turnstile = Turnstile(_REQUESTS_AT_ONCE)
        self.survey = Survey(_why_silent)
        """Knows our topics, and what is wrong with them."""
        self._spinners: dict[Lane, _Spinner] = {}
        self._nodes: list[Any] = []
        self._failed = asyncio.Event()
        self._reason = ""

    def node(self, name: str, lane: Lane) -> "_Node":
        """Create a node; its messages go to the event loop that is running now."""
        self.crossing.open()
        if lane not in self._spinners:
            self._spinners[lane] = _Spinner(self, lane)
        spinner = self._spinners[lane]
        namespace, _, own_name = name.rpartition("/")
        node = rclpy.create_node(
            own_name,
            namespace=f"/{namespace}",
            context=self.context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._nodes.append(node)
        spinner.executor.add_node(node)
        return _Node(self, spinner, node)

    def has_type(self, type_name: str) -> bool:
        """Tell whether a type of message or service is installed."""
        try:
            _find_type(type_name)
        except UnknownTypeError:
            return False
        return True

    def require_field(self, type_name: str, path: Sequence[str | int]) -> None:
        """Check that messages of a type have a field."""
        require_field(type_name, path)

    def drive_output(
        self, topic: str, type_name: str, wheelbase_m: float, owner: str = OWNER
    ) -> DriveProcess:
        """Return the output for drive commands: a process of its own."""
        # Commands speed 0 if that process ends.
        node = self.node(f"{owner}_stop", Lane.SENSORS)
        publisher = node.publisher(topic, type_name, Qos.COMMANDS)

        def publish(command: DriveCommand) -> None:
            publisher.publish(drive_message(command, type_name, wheelbase_m))

        return DriveProcess(topic, type_name, wheelbase_m, publish, node=f"{owner}_drive")

    async def look(self) -> Sequence[GraphFault]:
        """Look at some of our topics, and return what is known to be wrong in the graph now."""
        if not self._nodes or self.crossing.closed:
            return ()
        return await asyncio.to_thread(self.survey.look, self._nodes[0])

    async def wait_failed(self) -> None:
        """Wait until a lane fails.

        Raises:
            GraphFailedError: A lane failed; the log holds its exception.
        """
        await self._failed.wait()
        raise GraphFailedError(self._reason)

    async def close(self) -> None:
        """Leave the graph within 3 s; further calls do nothing."""
        if self.crossing.closed:
            return
        await self.crossing.close()
        # In a daemon: a middleware that hangs must not keep the process from ending.
        leaving = CallThread("leaving ROS 2")
        try:
            async with asyncio.timeout(_LEAVE_S):
                await leaving.run(self._leave)
        except TimeoutError:
            _log.error("ROS 2 was not shut down: the middleware hangs for %g s", _LEAVE_S)
        leaving.end()

    def _leave(self) -> None:
        threads: list[Sender | _Spinner] = [self.sender, *self._spinners.values()]
        for thread in threads:
            thread.stop()
        until = time.monotonic() + _JOIN_S
        ended = [thread.join(until - time.monotonic()) for thread in threads]
        if not all(ended):
            # Objects that a thread may still use cannot be destroyed; the process ends soon anyway.
            _log.error("ROS 2 was not shut down: a thread did not end within %g s", _JOIN_S)
            return
        for node in self._nodes:
            node.destroy_node()
        for spinner in self._spinners.values():
            spinner.executor.shutdown()
        self.context.try_shutdown()
        self.context.destroy()

    def fail(self, reason: str) -> None:
        """Report that a lane failed."""
        self._reason = reason
        self._failed.set()


class _GatheringExecutor(SingleThreadedExecutor):  # type: ignore[misc]  # rclpy has no stubs
    """Pauses before each wait, and so finds many messages in one wait while they keep coming.

    With a hundred clients a wait takes a millisecond, in which it holds the interpreter, however
    few messages it finds. The first message after a silence is not delayed.
    """

    def _wait_for_ready_callbacks(self, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401
        time.sleep(_GATHER_S)
        return super()._wait_for_ready_callbacks(*args, **kwargs)


class _Spinner:
    """The thread of a lane, and rclpy's executor in it."""

    def __init__(self, link: RosLink, lane: Lane) -> None:
        make = SingleThreadedExecutor if lane in _URGENT else _GatheringExecutor
        self.executor = make(context=link.context)
        self._link = link
        self._lane = lane
        self._stopping = False
        name = f"ros2 {lane.value}"
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)
        self._thread.start()

    def do(self, work: Callable[..., object], *arguments: object) -> None:
        """Call a function on this thread; it must not raise."""
        if not self._stopping:
            self.executor.create_task(work, *arguments)

    def stop(self) -> None:
        """Let the thread end after its current callback."""
        # Without this the thread would see the flag only with the next message.
        self.do(_nothing)
        self._stopping = True

    def join(self, within_s: float) -> bool:
        """Wait for the thread, and return whether it ended in time."""
        self._thread.join(max(within_s, 0.0))
        return not self._thread.is_alive()

    def _spin(self) -> None:
        try:
            while not self._stopping:
                self.executor.spin_once()
        except Exception as error:
            # The edge of this thread: the owner must be notified of whatever rclpy raises, for
            # example if something else in this process shut ROS down.
            if not self._stopping:
                reason = f"the ROS 2 thread of the lane {self._lane.value} failed: {error!r}"
                _log.critical(reason, exc_info=True)
                self._link.crossing.post(self._link.fail, reason)


class _Node:
    """A `RosNode` of rclpy."""

    def __init__(self, link: RosLink, spinner: _Spinner, node: Any) -> None:  # noqa: ANN401
        self._link = link
        self._spinner = spinner
        self._node = node

    def client(self, service: str, type_name: str) -> ServiceClient:
        """Return a client."""
        kind = _find_type(type_name)
        client = self._node.create_client(kind, service)
        return ServiceClient(self._link.crossing, self._link.turnstile, self._node, kind, client)

    def publisher(self, topic: str, type_name: str, qos: Qos) -> LinkPublisher:
        """Return a publisher."""
        kind = _find_type(type_name)
        self._link.survey.add(End(topic, type_name, _PROFILES[qos], publishes=True))
        publisher = self._node.create_publisher(
            kind, topic, _PROFILES[qos], event_callbacks=_NO_PUBLISHER_EVENTS
        )
        sender = None if qos is Qos.COMMANDS else self._link.sender
        return LinkPublisher(self._link.crossing, kind, publisher, topic, sender)

    def subscribe(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        pick: Callable[[Message], PickedT | None],
        take: Callable[[PickedT], None],
    ) -> None:
        """Subscribe to a topic while the link is open."""
        kind = _find_type(type_name)
        profile = _PROFILES[qos]
        self._link.survey.add(End(topic, type_name, profile, publishes=False))
        inbox = Inbox(self._link.crossing, topic, pick, take, profile.depth)
        drain = Drain(kind, inbox.hear)
        drain.attach(
            self._node.create_subscription(
                kind, topic, drain.hear, profile, event_callbacks=_NO_EVENTS
            )
        )

    def watch_arrivals(
        self, topic: str, type_name: str, hear: Callable[[int | None], None]
    ) -> None:
        """Hear when messages of a topic arrive."""
        kind = _find_type(type_name)
        has_stamp = begins_with_header(kind.get_fields_and_field_types())

        def arrive(serialized: bytes) -> None:
            hear(stamp_in(serialized) if has_stamp else None)

        _ArrivalWatch(self._node, kind, topic, arrive)

    def watch_liveliness(
        self, topic: str, type_name: str, lease_s: float, take: Callable[[bool], None]
    ) -> None:
        """Watch whether a topic has live publishers."""
        kind = _find_type(type_name)
        living = 0

        def change(status: Message) -> bool | None:
            nonlocal living
            if status.alive_count == living:
                return None
            living = int(status.alive_count)
            return living > 0

        def warn(_status: object) -> None:
            wanted = f"automatic liveliness with a lease of {lease_s:g} s or less"
            _log.warning("%s: ignored a publisher that does not have %s", topic, wanted)

        inbox = Inbox(self._link.crossing, topic, change, take, _LIVELINESS_DEPTH)
        profile = QoSProfile(
            depth=1,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            liveliness=LivelinessPolicy.AUTOMATIC,
            liveliness_lease_duration=Duration(seconds=lease_s),
        )
        events = SubscriptionEventCallbacks(
            liveliness=inbox.hear, incompatible_qos=warn, use_default_callbacks=False
        )
        self._node.create_subscription(kind, topic, _nothing, profile, event_callbacks=events)

    def serve(
        self, service: str, type_name: str, answer: Callable[[Fields], Awaitable[Fields]]
    ) -> None:
        """Offer a service while the link is open."""
        kind = _find_type(type_name)
        server = Server(self._link.crossing, service, kind.Response, answer, self._spinner.do)
        server.attach(self._node.create_service(kind, service, server.accept, qos_profile=_SERVING))

    def serve_action(self, action: str, type_name: str, handler: ActionHandler[GoalT]) -> None:
        """Offer an action while the link is open."""
        kind, link = _find_type(type_name), self._link
        goals = ActionGoals(link.crossing, link.sender, action, kind, handler, self._spinner.do)
        server = ActionServer(
            self._node,
            kind,
            action,
            _nothing,
            goal_callback=lambda goal: _GOALS[goals.judge(goal)],
            handle_accepted_callback=goals.accept,
            cancel_callback=lambda handle: _CANCELS[goals.cancel(handle)],
        )
        goals.attach(server)


class _ArrivalWatch:
    """A subscription to serialized messages that is as reliable as all their publishers are.

    A reliable one hears no publisher that is not. With best effort, a message that travels in many
    pieces, such as an image, is lost with any of them: of 30 images of 1 MB a second, one arrived.
    """

    def __init__(
        self,
        node: Any,  # noqa: ANN401
        kind: Any,  # noqa: ANN401
        topic: str,
        arrive: Callable[[bytes], None],
    ) -> None:
        """Subscribe; the thread of the lane looks once a second for other publishers."""
        self._node = node
        self._kind = kind
        self._topic = topic
        self._arrive = arrive
        self._reliability = ReliabilityPolicy.BEST_EFFORT
        self._subscription = self._subscribe()
        node.create_timer(_LOOK_S, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def _subscribe(self) -> Any:  # noqa: ANN401
        profile = QoSProfile(depth=_ARRIVALS_DEPTH, reliability=self._reliability)
        return self._node.create_subscription(
            self._kind, self._topic, self._arrive, profile, event_callbacks=_NO_EVENTS, raw=True
        )

    def _look(self) -> None:
        """Subscribe anew if the publishers are reliable now, or are not any more."""
        known = self._node.get_publishers_info_by_topic(self._topic)
        offered = {publisher.qos_profile.reliability for publisher in known}
        is_reliable = offered == {ReliabilityPolicy.RELIABLE}
        wanted = ReliabilityPolicy.RELIABLE if is_reliable else ReliabilityPolicy.BEST_EFFORT
        if known and wanted is not self._reliability:
            self._reliability = wanted
            self._node.destroy_subscription(self._subscription)
            self._subscription = self._subscribe()


def _find_type(type_name: str) -> Any:  # noqa: ANN401  # a class of ROS
    kind = find_type(type_name)
    try:
        check_for_type_support(kind)
    except (AttributeError, NoTypeSupportImportedException, UnsupportedTypeSupport) as error:
        # Not a ROS 2 type, or its shared libraries are missing or built for another Python.
        raise UnknownTypeError(type_name) from error
    return kind


def _why_silent(offered: QoSProfile, requested: QoSProfile) -> str:
    """Return why a subscription hears nothing of a publisher; empty: it does."""
    compatibility, reason = qos_check_compatible(offered, requested)
    # Of pybind11, whose values are made anew.
    if compatibility != QoSCompatibility.ERROR:
        return ""
    return str(reason).removeprefix("ERROR: ").rstrip("; ")


def _nothing(*_: object) -> None:
    """Do nothing."""
