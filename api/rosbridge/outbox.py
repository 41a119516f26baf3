"""What waits to be sent to one client, and in which order it goes."""

from collections import deque
from collections.abc import Callable

from api.rosbridge.subscription import Subscription
from domain.timebase import Instant

MAX_WAITING = 1_000
"""Events and answers that may wait; a client that lets more pile up has lost its way."""
_AT_ONCE = 100


class Outbox:
    """Answers and events go in order and without loss, then what is due of the other topics."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """Begin empty.

        Args:
            wake: Is told that there may be something to take; returns at once.
        """
        self.wake = wake
        self._waiting: deque[str] = deque()
        self._overflowed = False
        self._paced: dict[Subscription, None] = {}

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
        if len(self._waiting) >= MAX_WAITING:
            self._overflowed = True
            return
        self._waiting.append(text)
        self.wake()

    def add(self, subscription: Subscription) -> None:
        """Also take what is due of a subscription, from now on."""
        self._paced[subscription] = None

    def remove(self, subscription: Subscription) -> None:
        """Forget a subscription."""
        self._paced.pop(subscription, None)

    def take(self, now: Instant) -> list[str]:
        """Take out what is to be sent next: some texts, in order."""
        taken = [self._waiting.popleft() for _ in range(min(_AT_ONCE, len(self._waiting)))]
        if not self._waiting:
            for subscription in self._paced:
                taken += subscription.take(now)
        return taken
