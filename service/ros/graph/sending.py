"""Sending without delaying the tick of the event loop; knows no ROS.

To fill a message of fifty parts takes too long, and so do fifty requests in a row: messages are
published by a thread of its own, and requests go out a few at a time.
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
"""At most this many messages wait to be sent; further ones are dropped."""

_log = logging.getLogger(__name__)

Send: TypeAlias = Callable[[Fields], None]


class Turnstile:
    """Lets a few through in each pass of the event loop; the others follow in the next ones."""

    def __init__(self, at_once: int) -> None:
        """Begin.

        Args:
            at_once: How many pass together.
        """
        self._at_once = at_once
        self._passed = 0
        self._waiting: deque[asyncio.Future[None]] = deque()

    async def wait_for_turn(self) -> None:
        """Return when it is the caller's turn, in the order in which they came."""
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
            # Somebody who went while waiting leaves the turn to the next.
            if not turn.done():
                turn.set_result(None)
                self._count()


class Sender:
    """Sends messages in the order in which they were handed in."""

    def __init__(self) -> None:
        """Begin; the thread ends with `stop`."""
        self._waiting: queue.Queue[tuple[str, Send, Fields] | None] = queue.Queue(MAX_WAITING)
        self._stopping = False
        self._dropped = 0
        self._thread = threading.Thread(target=self._work, name="ros2 sender", daemon=True)
        self._thread.start()

    def send(self, topic: str, send: Send, message: Fields) -> None:
        """Have a message sent, and return at once; from one thread.

        Args:
            topic: Names it in the log.
            send: Is called with the message; it raises nothing but that a message is invalid.
            message: Must not be changed any more.
        """
        try:
            self._waiting.put_nowait((topic, send, message))
        except queue.Full:
            if not self._dropped:
                _log.warning("%s: messages are dropped, %d wait already", topic, MAX_WAITING)
            self._dropped += 1
        else:
            self._dropped = 0

    def stop(self) -> None:
        """Let the thread end; what waits is not sent any more."""
        self._stopping = True
        try:
            self._waiting.put_nowait(None)
        except queue.Full:
            # It is awake, and sees that it has to stop.
            return

    def join(self, within_s: float) -> bool:
        """Wait for the end of the thread, and tell whether it came."""
        self._thread.join(max(within_s, 0.0))
        return not self._thread.is_alive()

    def _work(self) -> None:
        while (item := self._waiting.get()) is not None and not self._stopping:
            topic, send, message = item
            send_or_tell(topic, send, message)


def send_or_tell(topic: str, send: Send, message: Fields) -> None:
    """Send a message; one that its type cannot hold must not end the others."""
    try:
        send(message)
    except InvalidValueError as error:
        _log.warning("not published on %s: %s", topic, error)
