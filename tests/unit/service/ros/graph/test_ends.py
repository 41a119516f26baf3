"""What is made over rclpy, with something that behaves as its objects do."""

from collections import deque
from types import SimpleNamespace

from service.ros.graph.crossing import Crossing
from service.ros.graph.ends import DRAINED, Drain, LinkPublisher


class Handle:
    """The handle of a subscription, with the messages that have arrived."""

    def __init__(self, *arrived: str) -> None:
        self.arrived = deque(arrived)
        self._is_held = False

    def __enter__(self) -> None:
        self._is_held = True

    def __exit__(self, *_: object) -> None:
        self._is_held = False

    def take_message(self, kind: type, raw: bool) -> tuple[str, object] | None:
        """Return the next message with what is known of it, as rclpy does."""
        assert kind is str
        assert not raw
        assert self._is_held, "it may be destroyed meanwhile"
        return (self.arrived.popleft(), object()) if self.arrived else None


def draining(handle: Handle) -> tuple[Drain, list[str]]:
    """Return what takes the messages of a handle, and where they end up."""
    heard: list[str] = []
    drain = Drain(str, heard.append)
    drain.attach(SimpleNamespace(handle=handle))
    return drain, heard


def test_messages_that_arrived_together_are_taken_together_in_their_order() -> None:
    drain, heard = draining(Handle("second", "third"))

    drain.hear("first")

    assert heard == ["first", "second", "third"]


def test_a_topic_in_a_storm_leaves_other_topics_their_turn() -> None:
    handle = Handle(*(str(number) for number in range(DRAINED + 10)))
    drain, heard = draining(handle)

    drain.hear("first")

    assert len(heard) == 1 + DRAINED
    assert len(handle.arrived) == 10


def test_a_message_before_the_subscription_is_known_is_heard() -> None:
    heard: list[str] = []

    Drain(str, heard.append).hear("first")

    assert heard == ["first"]


def test_a_publisher_tells_whether_anybody_subscribes() -> None:
    subscribed = SimpleNamespace(get_subscription_count=lambda: 1)
    crossing = Crossing()
    publisher = LinkPublisher(crossing, dict, subscribed, "/overlay", None)

    assert publisher.has_subscribers()
    crossing.closed = True
    assert not publisher.has_subscribers()
