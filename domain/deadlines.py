"""A queue of deadlines by key."""

import heapq
from collections.abc import Hashable
from typing import Generic, TypeVar

from domain.timebase import Instant

KeyT = TypeVar("KeyT", bound=Hashable)


class Deadlines(Generic[KeyT]):
    """At most one deadline per key; finding the next one needs no search."""

    def __init__(self) -> None:
        self._at: dict[KeyT, tuple[Instant, int]] = {}
        self._heap: list[tuple[Instant, int, KeyT]] = []
        self._count = 0

    def set(self, key: KeyT, at: Instant) -> None:
        """Set the deadline of `key`; it replaces an earlier one."""
        self._count += 1
        self._at[key] = (at, self._count)
        heapq.heappush(self._heap, (at, self._count, key))

    def clear(self, key: KeyT) -> None:
        """Remove the deadline of `key`, if any."""
        self._at.pop(key, None)

    def next(self) -> Instant | None:
        """Return the earliest deadline; None: there is none."""
        self._drop_forgotten()
        return self._heap[0][0] if self._heap else None

    def pop_due(self, now: Instant) -> KeyT | None:
        """Remove the earliest deadline that has passed and return its key; None: none has passed.

        Equal deadlines come in the order in which they were set.
        """
        self._drop_forgotten()
        if not self._heap or self._heap[0][0] > now:
            return None
        _, _, key = heapq.heappop(self._heap)
        del self._at[key]
        return key

    def _drop_forgotten(self) -> None:
        while self._heap and self._at.get(self._heap[0][2]) != self._heap[0][:2]:
            heapq.heappop(self._heap)
