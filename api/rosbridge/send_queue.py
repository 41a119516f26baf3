"""The queue of messages to one client, and their order."""

from collections import deque
from collections.abc import Callable

from api.rosbridge.subscription import Subscription
from domain.timebase import Instant

MAX_WAITING = 1_000
"""Events and responses that may wait; a client with more is disconnected."""
MAX_CHARACTERS = 4 * 1024 * 1024
"""Of all of these except the last one. The list of all services of a large robot alone has more
than 100,000 characters."""
_AT_ONCE = 100
_CHARACTERS_AT_ONCE = 65_536


class SendQueue:
    """Responses and events are sent in order and without loss, then messages of other topics."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """Start empty.

        Args:
            wake: Called when there may be something to take; must return at once.
        """
        self._wake = wake
        self._waiting: deque[str] = deque()
        self._characters = 0
        """Of all waiting texts."""
        self._overflowed = False
        self._paced: dict[Subscription, None] = {}
        """Only subscriptions with waiting messages, since a client may have a thousand others."""

    @property
    def overflowed(self) -> bool:
        """Tell whether a message was lost that must not be."""
        return self._overflowed

    @property
    def has_more(self) -> bool:
        """Tell whether there is more to send at once."""
        return bool(self._waiting)

    def put(self, text: str) -> None:
        """Append a text that must not be lost."""
        if len(self._waiting) >= MAX_WAITING or self._characters >= MAX_CHARACTERS:
            self._overflowed = True
        else:
            self._waiting.append(text)
            self._characters += len(text)
        self._wake()

    def expect(self, subscription: Subscription) -> None:
        """Remember a subscription with waiting messages; they are taken when they are due."""
        self._paced[subscription] = None
        self._wake()

    def remove(self, subscription: Subscription) -> None:
        """Forget a subscription."""
        self._paced.pop(subscription, None)

    def take(self, now: Instant) -> list[str]:
        """Remove and return the texts to send next, in order."""
        taken: list[str] = []
        room = _CHARACTERS_AT_ONCE
        while self._waiting and len(taken) < _AT_ONCE and room > 0:
            taken.append(self._waiting.popleft())
            room -= len(taken[-1])
        self._characters -= _CHARACTERS_AT_ONCE - room
        if not self._waiting:
            for subscription in (*self._paced,):
                taken += subscription.take(now)
                if not subscription.has_waiting:
                    del self._paced[subscription]
        return taken
