"""Sends messages without delaying the tick of the event loop; imports no ROS.

Filling a message with fifty parts takes too long, and so do fifty requests in a row. So messages
are published by a separate thread, and requests are sent a few at a time.
"""

import asyncio
import logging
import queue
import threading
from collections import deque
from collections.abc import Callable
from typing import TypeAlias

from domain.errors import InvalidValueError
from service.ros.graph.graph import Fields

MAX_WAITING = 1_000
"""Capacity for messages that wait to be sent; further ones are dropped."""

_log = logging.getLogger(__name__)

Send: TypeAlias = Callable[[Fields], None]


class Turnstile:
    """Lets a few callers through in each pass of the event loop; the others wait for the next."""

    def __init__(self, at_once: int) -> None:
        """Prepare.

        Args:
            at_once: Callers per pass of the event loop.
        """
        self._at_once = at_once
        self._passed = 0
        self._waiting: deque[asyncio.Future[None]] = deque()

    async def wait_for_turn(self) -> None:
        """Return when it is the caller's turn; callers keep their order."""
        if self._passed == self._at_once:
            turn: asyncio.Future[None] = asyncio.get_running_loop().create_future()
            self._waiting.append(turn)
            await turn
        else:
            self._count()

    def _count(self) -> None:
        if not self._passed:
            asyncio.get_running_loop().call_soon(self._begin_next)
        self._passed += 1

    def _begin_next(self) -> None:
        self._passed = 0
        while self._waiting and self._passed < self._at_once:
            turn = self._waiting.popleft()
            # A caller that was cancelled while waiting leaves its turn to the next.
            if not turn.done():
                turn.set_result(None)
                self._count()


class Sender:
    """Sends messages in the order in which they were handed in."""

    def __init__(self) -> None:
        """Start the thread; `stop` ends it."""
        self._waiting: queue.Queue[tuple[str, Send, Fields] | None] = queue.Queue(MAX_WAITING)
        self._stopping = False
        self._dropped = 0
        self._thread = threading.Thread(target=self._work, name="ros2 sender", daemon=True)
        self._thread.start()

    def send(self, topic: str, send: Send, message: Fields) -> None:
        """Queue a message, and return at once; always call this from the same thread.

        Args:
            topic: For the log.
            send: Called with the message; may raise only InvalidValueError.
            message: Must not be changed any more.
        """
        try:
            self._waiting.put_nowait((topic, send, message))
        except queue.Full:
            if not self._dropped:
                _log.warning("%s: messages are dropped, %d already wait", topic, MAX_WAITING)
            self._dropped += 1
        else:
            self._dropped = 0

    def stop(self) -> None:
        """Let the thread end; queued messages are not sent any more."""
        self._stopping = True
        try:
            self._waiting.put_nowait(None)
        except queue.Full:
            # The thread is awake, and sees the flag.
            return

    def join(self, within_s: float) -> bool:
        """Wait for the thread, and return whether it ended in time."""
        self._thread.join(max(within_s, 0.0))
        return not self._thread.is_alive()

    def _work(self) -> None:
        while (item := self._waiting.get()) is not None and not self._stopping:
            topic, send, message = item
            send_or_tell(topic, send, message)


def send_or_tell(topic: str, send: Send, message: Fields) -> None:
    """Send a message; an invalid one is logged and must not end the thread."""
    try:
        send(message)
    except InvalidValueError as error:
        _log.warning("not published on %s: %s", topic, error)
