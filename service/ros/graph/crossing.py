"""The way from the threads of ROS to the event loop, and back for a response; knows no ROS.

All that is heard goes through one `Crossing`. What waits there for a busy event loop is bounded: a
topic keeps its newest messages, and a service its first requests.
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
"""At most this many requests to one service of ours wait; more get an empty response."""

_CANCEL_S = 0.5
_AT_ONCE = 20
"""At most this many messages of a topic are taken in one pass of the event loop."""

_log = logging.getLogger(__name__)

PickedT = TypeVar("PickedT")


class Crossing:
    """The event loop as other threads see it, and the tasks that they begin there."""

    def __init__(self) -> None:
        self.closed = False
        """Whether nothing crosses any more."""
        self._loop: asyncio.AbstractEventLoop | None = None
        self._tasks: set[asyncio.Task[None]] = set()

    def open(self) -> None:
        """Lead to the event loop that runs now."""
        self._loop = asyncio.get_running_loop()

    def post(self, callback: Callable[..., object], *arguments: object) -> None:
        """Have something called on the event loop's thread; from any thread.

        It is called only while the crossing is not closed.
        """
        if self.closed or self._loop is None:
            return
        try:
            self._loop.call_soon_threadsafe(self._call, callback, *arguments)
        except RuntimeError:
            # The loop has been closed: there is nobody any more who could be told.
            return

    def call_next(self, callback: Callable[..., object], *arguments: object) -> None:
        """Have something called in the next pass of the loop; from its own thread, as `post`."""
        asyncio.get_running_loop().call_soon(self._call, callback, *arguments)

    def own(self, work: Coroutine[object, object, None], name: str) -> None:
        """Run something as a task until it ends or the crossing is closed."""
        task = asyncio.create_task(work, name=name)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def close(self) -> None:
        """Let nothing cross any more, and cancel what runs."""
        self.closed = True
        for task in self._tasks:
            task.cancel()
        if self._tasks:
            await asyncio.wait(self._tasks, timeout=_CANCEL_S)

    def _call(self, callback: Callable[..., object], *arguments: object) -> None:
        if not self.closed:
            callback(*arguments)


class Inbox(Generic[PickedT]):
    """What is heard of one topic, on its way to the event loop."""

    def __init__(
        self,
        crossing: Crossing,
        topic: str,
        pick: Callable[[Message], PickedT | None],
        take: Callable[[PickedT], None],
        depth: int,
    ) -> None:
        """Make an empty one.

        Args:
            crossing: Leads to the event loop.
            topic: Names it in the log.
            pick: Takes out of a message what matters, on the thread that hears it; None: nothing.
            take: Is handed that, on the event loop's thread.
            depth: How many wait; when one more comes, the oldest is dropped.
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
        """Hand a message over; from the thread that hears it."""
        try:
            picked = self._pick(message)
        except Exception:
            # The edge to whoever listens: a message must not cost the thread, and with it all
            # others. Told once, since what is wrong with one is wrong with the next.
            if not self._complained:
                _log.exception("%s: messages are dropped, the first for this:", self._topic)
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
            _log.warning(
                "%s: %d messages were dropped, the event loop was busy", self._topic, dropped
            )
        for item in items:
            # One call each, so that what is raised over one does not cost the others.
            self._crossing.call_next(self._take, item)
        if has_more:
            self._crossing.call_next(self._hand_out)


class Server:
    """A service of ours whose responses take their time.

    rclpy sends what a callback returns as soon as it returns, and polls without a pause whatever
    it awaits. So the callback returns the request, and what should send that keeps it instead.
    """

    def __init__(
        self,
        crossing: Crossing,
        name: str,
        response: Callable[[], Message],
        answer: Callable[[Fields], Awaitable[Fields]],
        do: Callable[..., None],
    ) -> None:
        """Make one that has no service yet.

        Args:
            crossing: Leads to the event loop.
            name: Full name of the service.
            response: Makes an empty response.
            answer: As of `RosNode.serve`.
            do: Calls a function with arguments on the thread that hears the requests.
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
        """Return the request, so that it comes to where the response should be sent."""
        # The thread that hears it may be faster than the call that made the service.
        self._attached.wait(timeout=1.0)
        return request

    def _keep(self, request: Message, header: object) -> None:
        if self._room.acquire(blocking=False):
            self._crossing.post(self._begin, request, header)
            return
        if not self._complained:
            _log.warning("%s: %d requests wait; more are refused", self._name, MAX_UNANSWERED)
        self._complained = True
        self._respond(self._response(), header)

    def _begin(self, request: Message, header: object) -> None:
        self._crossing.own(self._work(request, header), f"answer of {self._name}")

    async def _work(self, request: Message, header: object) -> None:
        response = self._response()
        try:
            fill(response, await self._answer(fields_of(request)))
        except Exception:
            # The edge to whoever answers: a fault in one answer must not cost the service.
            _log.exception("%s: a request gets an empty response, for this:", self._name)
        self._do(self._finish, response, header)

    def _finish(self, response: Message, header: object) -> None:
        self._room.release()
        self._complained = False
        self._respond(response, header)

    def _respond(self, response: Message, header: object) -> None:
        try:
            self._send(response, header)
        except RuntimeError as error:
            # The errors of rclpy are such: whoever asked is gone.
            _log.info("%s: a response could not be sent: %s", self._name, error)
