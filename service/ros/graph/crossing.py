"""Passes messages from the threads of ROS to the event loop, and responses back; imports no ROS.

Everything that is received goes through one `Crossing`. While the event loop is busy, queues are
bounded: a topic keeps its newest messages, a service its first requests.
"""

import asyncio
import logging
import threading
from collections import deque
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any, Generic, TypeVar

from service.ros.graph.conversion import fields_of, fill
from service.ros.graph.graph import Fields, Message

MAX_UNANSWERED = 32
"""Most unanswered requests to one of our services; further ones get an empty response."""

POSTS_AT_ONCE = 4
"""Most calls from other threads in one pass of the event loop. Fifty nodes answer at the same time,
and what follows from an answer takes a tenth of a millisecond and more, and twice as long while a
lane wants the interpreter."""

_CANCEL_S = 0.5
_AT_ONCE = 20
"""Most messages of a topic that are processed in one pass of the event loop."""

_log = logging.getLogger(__name__)

PickedT = TypeVar("PickedT")


class Crossing:
    """Access to the event loop from other threads, and the tasks that they start there."""

    def __init__(self) -> None:
        self.closed = False
        """Whether the crossing is closed: nothing is passed on any more."""
        self._loop: asyncio.AbstractEventLoop | None = None
        self._posted: deque[tuple[Callable[..., object], tuple[object, ...]]] = deque()
        self._lock = threading.Lock()
        self._tasks: set[asyncio.Task[None]] = set()

    def open(self) -> None:
        """Connect to the running event loop."""
        loop = asyncio.get_running_loop()
        if loop is not self._loop:
            self._posted.clear()
        self._loop = loop

    def post(self, callback: Callable[..., object], *arguments: object) -> None:
        """Call a function on the event loop's thread; may be used from any thread.

        The function is not called once the crossing is closed. Many calls wake the loop once.
        """
        if self.closed or self._loop is None:
            return
        with self._lock:
            first = not self._posted
            self._posted.append((callback, arguments))
        if not first:
            return
        try:
            self._loop.call_soon_threadsafe(self._hand_on)
        except RuntimeError:
            # The loop is closed: nothing is left that could process the call.
            return

    def call_next(self, callback: Callable[..., object], *arguments: object) -> None:
        """Call a function in the next pass of the loop, as `post`; only from the loop's thread."""
        asyncio.get_running_loop().call_soon(self._call, callback, *arguments)

    def own(self, work: Coroutine[object, object, None], name: str) -> None:
        """Run a coroutine as a task until it ends or the crossing is closed."""
        task = asyncio.create_task(work, name=name)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def close(self) -> None:
        """Pass nothing on any more, and cancel the running tasks."""
        self.closed = True
        for task in self._tasks:
            task.cancel()
        if self._tasks:
            await asyncio.wait(self._tasks, timeout=_CANCEL_S)

    def _hand_on(self) -> None:
        """Call some of the posted functions, and the others in the next passes of the loop."""
        with self._lock:
            count = min(len(self._posted), POSTS_AT_ONCE)
            posted = [self._posted.popleft() for _ in range(count)]
            has_more = bool(self._posted)
        for callback, arguments in posted:
            # One call each, so that an exception in one does not lose the others.
            self.call_next(callback, *arguments)
        if has_more:
            asyncio.get_running_loop().call_soon(self._hand_on)

    def _call(self, callback: Callable[..., object], *arguments: object) -> None:
        if not self.closed:
            callback(*arguments)


class Inbox(Generic[PickedT]):
    """The queue of one topic's messages for the event loop."""

    def __init__(
        self,
        crossing: Crossing,
        topic: str,
        pick: Callable[[Message], PickedT | None],
        take: Callable[[PickedT], None],
        depth: int,
    ) -> None:
        """Make an empty queue.

        Args:
            crossing: Passes messages to the event loop.
            topic: For the log.
            pick: Extracts what is needed from a message, on the receiving thread; None: nothing.
            take: Called with that on the event loop's thread.
            depth: Capacity; when it is exceeded, the oldest message is dropped.
        """
        self._crossing = crossing
        self._topic = topic
        self._pick = pick
        self._take = take
        self._waiting: deque[PickedT] = deque(maxlen=depth)
        self._dropped = 0
        self._complained = False
        self._lock = threading.Lock()

    def hear(self, message: Message) -> None:
        """Queue a message; called on the receiving thread."""
        try:
            picked = self._pick(message)
        except Exception:
            # The edge to the subscriber: its fault must not end the thread, and with it all other
            # subscriptions. Logged once, since further messages are likely to fail in the same way.
            if not self._complained:
                _log.exception("%s: messages are dropped; the first one because of:", self._topic)
            self._complained = True
            return
        if picked is not None:
            self._put(picked)

    def _put(self, item: PickedT) -> None:
        with self._lock:
            first = not self._waiting
            self._dropped += len(self._waiting) == self._waiting.maxlen
            self._waiting.append(item)
        if first:
            self._crossing.post(self._hand_out)

    def _hand_out(self) -> None:
        with self._lock:
            items = [self._waiting.popleft() for _ in range(min(len(self._waiting), _AT_ONCE))]
            has_more = bool(self._waiting)
            dropped, self._dropped = self._dropped, 0
        if dropped:
            _log.warning("%s: dropped %d messages, the event loop was busy", self._topic, dropped)
        for item in items:
            # One call each, so that an exception over one message does not lose the others.
            self._crossing.call_next(self._take, item)
        if has_more:
            self._crossing.call_next(self._hand_out)


class Server:
    """A ROS service whose responses may take long.

    rclpy sends the return value of a callback as soon as it returns, and busy-waits if the callback
    awaits anything. So the callback returns the request, and `send_response` is replaced: it starts
    the work, and the response is sent when that has ended.
    """

    def __init__(
        self,
        crossing: Crossing,
        name: str,
        response: Callable[[], Message],
        answer: Callable[[Fields], Awaitable[Fields]],
        do: Callable[..., None],
    ) -> None:
        """Prepare; `attach` connects it to the service.

        Args:
            crossing: Passes requests to the event loop.
            name: Full name of the service.
            response: Makes an empty response.
            answer: As for `RosNode.serve`.
            do: Calls a function with arguments on the thread that receives the requests.
        """
        self._crossing = crossing
        self._name = name
        self._response = response
        self._answer = answer
        self._do = do
        self._room = threading.BoundedSemaphore(MAX_UNANSWERED)
        self._complained = False
        self._attached = threading.Event()
        self._send: Callable[[Message, object], None]

    def attach(self, service: Any) -> None:  # noqa: ANN401  # rclpy's
        """Take over the responses of a service whose callback is `accept`."""
        self._send = service.send_response
        service.send_response = self._keep
        self._attached.set()

    def accept(self, request: Message, _response: Message) -> Message:
        """Return the request, so that rclpy passes it to `_keep` in place of a response."""
        # The receiving thread may be faster than the call that makes the service.
        self._attached.wait(timeout=1.0)
        return request

    def _keep(self, request: Message, header: object) -> None:
        if self._room.acquire(blocking=False):
            # Read here, since the waypoints of a task take longer than a tick may be late.
            self._crossing.post(self._begin, fields_of(request), header)
            return
        if not self._complained:
            _log.warning("%s: %d requests wait; more are rejected", self._name, MAX_UNANSWERED)
        self._complained = True
        self._respond(self._response(), header)

    def _begin(self, request: Fields, header: object) -> None:
        self._crossing.own(self._work(request, header), f"answer of {self._name}")

    async def _work(self, request: Fields, header: object) -> None:
        response = self._response()
        try:
            fill(response, await self._answer(request))
        except Exception:
            # The edge to the handler: a fault in one response must not end the service.
            _log.exception("%s: a request gets an empty response because of:", self._name)
        self._do(self._finish, response, header)

    def _finish(self, response: Message, header: object) -> None:
        self._room.release()
        self._complained = False
        self._respond(response, header)

    def _respond(self, response: Message, header: object) -> None:
        try:
            self._send(response, header)
        except RuntimeError as error:
            # rclpy raises RuntimeError if the client is gone.
            _log.info("%s: could not send a response: %s", self._name, error)
