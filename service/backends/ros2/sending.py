"""Publishing by a thread of its own; knows no ROS.

To fill a message of fifty parts takes longer than the event loop may be kept from its tick.
"""

import logging
import queue
import threading
from collections.abc import Callable
from typing import TypeAlias

from domain.errors import InvalidValueError
from service.backends.ros2.graph import Fields

MAX_WAITING = 1_000
"""So many messages wait to be sent; further ones are dropped."""

_log = logging.getLogger(__name__)

Send: TypeAlias = Callable[[Fields], None]


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
