"""What one client gets of one topic, and how often."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

from api.rosbridge.replies import PublishedTexts
from domain.timebase import Duration, Instant
from service.ros.interface.endpoints import Fields, OfferedTopic

MAX_QUEUE = 100
"""Messages of a topic that may wait for their turn, however many a client asks for."""

_SNAPSHOTS = frozenset(
    {
        "diagnostic_msgs/msg/DiagnosticArray",
        "gem_state_msgs/msg/SystemStateStamped",
        "gem_state_msgs/msg/TaskPlannerStatus",
    }
)
"""Of these a newer message says all that an older one did: who is slow gets the newest."""


@dataclass(frozen=True, slots=True)
class Pace:
    """How often a client wants messages."""

    least: Duration = 0
    """Time between two messages, at least."""
    queue_length: int = 0
    """So many wait for their turn, and the oldest goes; 0: what is best for the topic."""


class Subscription:
    """A topic as a client named it; several wishes of the client are met by the fullest of them."""

    def __init__(
        self,
        topic: OfferedTopic,
        named: str,
        texts: PublishedTexts,
        put: Callable[[str], None],
        expect: Callable[["Subscription"], None],
    ) -> None:
        """Begin without a wish.

        Args:
            topic: What is subscribed to.
            named: Its name as the client wrote it.
            texts: Makes the text of a message.
            put: Takes a text that must not be lost.
            expect: Is handed this subscription once `take` has something, now or when it is due.
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
        """Tell whether there is a wish left."""
        return bool(self._wishes)

    @property
    def has_waiting(self) -> bool:
        """Tell whether a message waits for its turn."""
        return bool(self._waiting)

    def want(self, wish: str | int | None, pace: Pace) -> int:
        """Add a wish, or replace the one of that id; return how many more there are now: 1 or 0."""
        before = len(self._wishes)
        self._wishes[wish] = pace
        self._adopt()
        return len(self._wishes) - before

    def unwant(self, wish: str | int | None) -> int:
        """Forget a wish, or with None all; return how many there were of it."""
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
        if pace == Pace() and self._topic.type not in _SNAPSHOTS:
            self._put(self._texts.text(self._topic.name, self._named, message))
        else:
            self._waiting.append(message)
            self._expect(self)

    def take(self, now: Instant) -> list[str]:
        """Take out the texts of what is due."""
        if not self._waiting or (self._due_at is not None and now < self._due_at):
            return []
        least = self._pace.least
        if least and self._due_at is not None and now - self._due_at < least:
            # On a grid, so that a message that is a little late makes not all others later.
            self._due_at += least
        else:
            self._due_at = now + least
        due = [self._waiting.popleft()] if least else [*self._waiting]
        if not least:
            self._waiting.clear()
        return [self._texts.text(self._topic.name, self._named, message) for message in due]

    def _adopt(self) -> None:
        """Go at the pace of the wishes together."""
        if not self._wishes:
            return
        least = min(pace.least for pace in self._wishes.values())
        longest = max(pace.queue_length for pace in self._wishes.values())
        self._pace = Pace(least, min(longest, MAX_QUEUE))
        self._waiting = deque(self._waiting, maxlen=max(1, self._pace.queue_length))
        self._due_at = None
