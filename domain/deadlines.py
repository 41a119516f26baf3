"""Queues of deadlines by key."""

import heapq
from collections.abc import Hashable
from typing import Generic, TypeAlias, TypeVar

from domain.timebase import Instant

KeyT = TypeVar("KeyT", bound=Hashable)

_Entry: TypeAlias = tuple[Instant, int, KeyT]
"""A deadline, a number that rises with each that is set, and whose it is."""

_SPARE = 64
"""Replaced deadlines that a queue holds at least before it is tidied."""


class Deadlines(Generic[KeyT]):
    """At most one deadline per key; finding the next one needs no search."""

    def __init__(self) -> None:
        self._at: dict[KeyT, _Entry[KeyT]] = {}
        self._heap: list[_Entry[KeyT]] = []
        self._queued: dict[KeyT, _Entry[KeyT]] = {}
        """By key, the entry of the heap that its deadline is found by: the same, or an earlier one.

        A deadline that is put off, as by each reading, leaves the heap alone until it comes up.
        """
        self._count = 0

    def __contains__(self, key: KeyT) -> bool:
        """Tell whether a key has a deadline."""
        return key in self._at

    def at(self, key: KeyT) -> Instant | None:
        """Return the deadline of `key`; None: it has none."""
        entry = self._at.get(key)
        return None if entry is None else entry[0]

    def set(self, key: KeyT, at: Instant) -> None:
        """Set the deadline of `key`; it replaces an earlier one."""
        self._count += 1
        entry = self._at[key] = (at, self._count, key)
        queued = self._queued.get(key)
        if queued is None or queued[0] > at:
            self._queue(entry)

    def clear(self, key: KeyT) -> None:
        """Remove the deadline of `key`, if any."""
        self._at.pop(key, None)

    def next(self) -> Instant | None:
        """Return the earliest deadline; None: there is none."""
        self._drop_forgotten()
        return self._heap[0][0] if self._heap else None

    def first(self) -> KeyT | None:
        """Return whose deadline is the earliest; None: there is none."""
        self._drop_forgotten()
        return self._heap[0][2] if self._heap else None

    def pop_due(self, now: Instant) -> KeyT | None:
        """Remove the earliest deadline that has passed and return its key; None: none has passed.

        Equal deadlines come in the order in which they were set.
        """
        self._drop_forgotten()
        if not self._heap or self._heap[0][0] > now:
            return None
        _, _, key = heapq.heappop(self._heap)
        del self._at[key], self._queued[key]
        return key

    def _queue(self, entry: _Entry[KeyT]) -> None:
        self._queued[entry[2]] = entry
        heapq.heappush(self._heap, entry)
        if len(self._heap) > 2 * len(self._at) + _SPARE:
            # What was replaced by an earlier deadline would fill the memory before it comes up.
            self._queued = dict(self._at)
            self._heap = list(self._at.values())
            heapq.heapify(self._heap)

    def _drop_forgotten(self) -> None:
        """Take from the top of the heap what is no deadline, or one that was put off."""
        heap, deadlines, queued = self._heap, self._at, self._queued
        while heap:
            top = heap[0]
            key = top[2]
            entry = deadlines.get(key)
            if entry is top:
                return
            if queued.get(key) is not top:
                heapq.heappop(heap)
            elif entry is None:
                heapq.heappop(heap)
                del queued[key]
            else:
                queued[key] = entry
                heapq.heapreplace(heap, entry)


class SharedDeadlines(Generic[KeyT]):
    """As `Deadlines`, for keys of which thousands have the same deadline."""

    def __init__(self) -> None:
        self._at: dict[KeyT, Instant] = {}
        self._keys: dict[Instant, dict[KeyT, None]] = {}
        """In the order in which they were set."""
        self._heap: list[Instant] = []

    def __contains__(self, key: KeyT) -> bool:
        """Tell whether a key has a deadline."""
        return key in self._at

    def set(self, key: KeyT, at: Instant) -> None:
        """Set the deadline of `key`; it replaces an earlier one."""
        self.clear(key)
        self._at[key] = at
        keys = self._keys.get(at)
        if keys is None:
            keys = self._keys[at] = {}
            heapq.heappush(self._heap, at)
        keys[key] = None

    def clear(self, key: KeyT) -> None:
        """Remove the deadline of `key`, if any."""
        at = self._at.pop(key, None)
        if at is not None:
            del self._keys[at][key]

    def next(self) -> Instant | None:
        """Return the earliest deadline; None: there is none."""
        while self._heap and not self._keys[self._heap[0]]:
            del self._keys[heapq.heappop(self._heap)]
        return self._heap[0] if self._heap else None

    def pop_due(self, now: Instant) -> tuple[KeyT, ...]:
        """Remove the earliest deadline that has passed and return its keys; empty: none has."""
        at = self.next()
        if at is None or at > now:
            return ()
        keys = tuple(self._keys.pop(heapq.heappop(self._heap)))
        for key in keys:
            del self._at[key]
        return keys
