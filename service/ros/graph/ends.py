"""Publishers and subscriptions over those of rclpy, which are given; imports no ROS."""

from collections.abc import Callable
from typing import Any

from service.ros.graph.conversion import fill
from service.ros.graph.crossing import Crossing
from service.ros.graph.graph import Fields, Message
from service.ros.graph.sending import Sender, send_or_tell

DRAINED = 8
"""Most messages of a topic that are taken in one go. With 50, a storm of reports took so much of
the interpreter that an emergency stop waited for it."""


class Drain:
    """Takes all messages of a topic that have arrived, whenever rclpy takes one.

    rclpy takes one message of a topic, and then waits again for all topics, which takes longer than
    the message.
    """

    def __init__(self, kind: Any, hear: Callable[[Message], None]) -> None:  # noqa: ANN401
        """Prepare; `attach` connects it to the subscription whose callback is `hear`.

        Args:
            kind: Type of the messages.
            hear: Gets each message.
        """
        self._kind = kind
        self._hear = hear
        self._handle: Any = None

    def attach(self, subscription: Any) -> None:  # noqa: ANN401  # of rclpy
        """Take further messages from this subscription."""
        self._handle = subscription.handle

    def hear(self, message: Message) -> None:
        """Take a message, and those that have arrived with it."""
        self._hear(message)
        handle = self._handle
        # The receiving thread may be faster than the call that makes the subscription.
        if handle is None:
            return
        for _ in range(DRAINED):
            with handle:
                taken = handle.take_message(self._kind, False)
            if taken is None:
                return
            self._hear(taken[0])


class LinkPublisher:
    """A `Publisher` of rclpy."""

    def __init__(
        self,
        crossing: Crossing,
        kind: Any,  # noqa: ANN401
        publisher: Any,  # noqa: ANN401
        topic: str,
        sender: Sender | None,
    ) -> None:
        """Prepare.

        Args:
            crossing: Nothing is sent once it is closed.
            kind: Type of the messages.
            publisher: Of rclpy.
            topic: For the log.
            sender: Thread that sends the messages; None: `publish` sends them itself.
        """
        self._crossing = crossing
        self._kind = kind
        self._publisher = publisher
        self._topic = topic
        self._sender = sender

    def publish(self, message: Fields) -> None:
        """Publish a message."""
        if self._sender is None:
            send_or_tell(self._topic, self._send, message)
        else:
            self._sender.send(self._topic, self._send, message)

    def has_subscribers(self) -> bool:
        """Tell whether the graph knows a subscription."""
        return not self._crossing.closed and self._publisher.get_subscription_count() > 0

    def _send(self, message: Fields) -> None:
        filled = self._kind()
        fill(filled, message)
        if not self._crossing.closed:
            self._publisher.publish(filled)
