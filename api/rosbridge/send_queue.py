"""What waits to be sent to one client, and in which order it goes."""

from collections import deque
from collections.abc import Callable

from api.rosbridge.subscription import Subscription
from domain.timebase import Instant

MAX_WAITING = 1_000
"""Events and answers that may wait; a client that lets more pile up has lost its way."""
MAX_CHARACTERS = 4 * 1024 * 1024
"""Of these together, beside the last one: of a large robot, a list of all services has some 100,000
characters and more."""
_AT_ONCE = 100
_CHARACTERS_AT_ONCE = 65_536


class SendQueue:
    """Answers and events go in order and without loss, then what is due of the other topics."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """Begin empty.

        Args:
            wake: Is told that there may be something to take; returns at once.
        """
        self._wake = wake
        self._waiting: deque[str] = deque()
        self._characters = 0
        """Of what waits."""
        self._overflowed = False
        self._paced: dict[Subscription, None] = {}
        """Those in which something waits: a client may have a thousand that are silent."""

    @property
    def overflowed(self) -> bool:
        """Tell whether something was lost that must not be."""
        return self._overflowed

    @property
    def has_more(self) -> bool:
        """Tell whether something is left that need not wait for its time."""
        return bool(self._waiting)

    def put(self, text: str) -> None:
        """Append what must not be lost."""
        if len(self._waiting) >= MAX_WAITING or self._characters >= MAX_CHARACTERS:
            self._overflowed = True
        else:
            self._waiting.append(text)
            self._characters += len(text)
        self._wake()

    def expect(self, subscription: Subscription) -> None:
        """Also take what is due of a subscription in which something waits."""
        self._paced[subscription] = None
        self._wake()

    def remove(self, subscription: Subscription) -> None:
        """Forget a subscription."""
        self._paced.pop(subscription, None)

    def take(self, now: Instant) -> list[str]:
        """Take out what is to be sent next: some texts, in order."""
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
