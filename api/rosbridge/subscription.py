"""The subscription of one client to one topic, and its rate."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from api.rosbridge.replies import PublishedTexts
from domain.timebase import Duration, Instant
from service.ros.interface.endpoints import Fields, OfferedTopic
from service.ros.interface.message_sets import own_type

MAX_QUEUE = 100
"""Upper limit of the `queue_length` that a client requests."""

_SNAPSHOTS = frozenset(
    {
        "diagnostic_msgs/msg/DiagnosticArray",
        "nav_msgs/msg/Path",
        "pilothouse_msgs/msg/SystemState",
        "pilothouse_msgs/msg/TaskStatus",
        "visualization_msgs/msg/MarkerArray",
    }
)
"""Types whose newest message replaces older ones: a slow client gets only the newest."""


@dataclass(frozen=True, slots=True)
class Pace:
    """The rate at which a client wants messages."""

    least: Duration = 0
    """Least time between two messages."""
    queue_length: int = 0
    """Messages that are queued, the oldest is dropped first; 0: the default of the topic."""


class Subscription:
    """A topic as a client named it; of several `subscribe` operations the fastest is in force."""

    def __init__(
        self,
        topic: OfferedTopic,
        named: str,
        texts: PublishedTexts,
        put: Callable[[str], None],
        expect: Callable[["Subscription"], None],
    ) -> None:
        """Start without a `subscribe` operation.

        Args:
            topic: The topic.
            named: Its name as the client wrote it.
            texts: Encodes messages.
            put: Takes a text that must not be lost.
            expect: Called with this subscription when a message waits, due now or later.
        """
        self._topic = topic
        self._named = named
        self._texts = texts
        self._put = put
        self._expect = expect
        self._wishes: dict[str | int | None, Pace] = {}
        self._pace = Pace()
        self._waiting: deque[Fields] = deque(maxlen=1)
        self._due_at: Instant | None = None

    @property
    def is_wanted(self) -> bool:
        """Tell whether a `subscribe` operation is in force."""
        return bool(self._wishes)

    @property
    def has_waiting(self) -> bool:
        """Tell whether a message waits."""
        return bool(self._waiting)

    def want(self, wish: str | int | None, pace: Pace) -> int:
        """Add a `subscribe` operation, or replace that of the same id; return how many are new."""
        before = len(self._wishes)
        self._wishes[wish] = pace
        self._adopt()
        return len(self._wishes) - before

    def unwant(self, wish: str | int | None) -> int:
        """Remove the `subscribe` operation of an id, or all with None; return how many."""
        before = len(self._wishes)
        if wish is None:
            self._wishes.clear()
        else:
            self._wishes.pop(wish, None)
        self._adopt()
        return before - len(self._wishes)

    def hear(self, message: Fields) -> None:
        """Take a message of the topic."""
        pace = self._pace
        if pace == Pace() and own_type(self._topic.type) not in _SNAPSHOTS:
            self._put(self._texts.text(self._topic.name, self._named, message))
        else:
            self._waiting.append(message)
            self._expect(self)

    def take(self, now: Instant) -> list[str]:
        """Remove and return the texts of the messages that are due."""
        if not self._waiting or (self._due_at is not None and now < self._due_at):
            return []
        least = self._pace.least
        if least and self._due_at is not None and now - self._due_at < least:
            # On a grid, so that one late message does not delay all later ones.
            self._due_at += least
        else:
            self._due_at = now + least
        due = [self._waiting.popleft()] if least else [*self._waiting]
        if not least:
            self._waiting.clear()
        return [self._texts.text(self._topic.name, self._named, message) for message in due]

    def _adopt(self) -> None:
        """Combine the rates of all `subscribe` operations."""
        if not self._wishes:
            return
        least = min(pace.least for pace in self._wishes.values())
        longest = max(pace.queue_length for pace in self._wishes.values())
        self._pace = Pace(least, min(longest, MAX_QUEUE))
        self._waiting = deque(self._waiting, maxlen=max(1, self._pace.queue_length))
        self._due_at = None
