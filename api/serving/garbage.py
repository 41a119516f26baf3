"""Keeps garbage collections from holding up the event loop.

Each full collection looks at every object that is not frozen. The events alone are tens of
thousands after a while, which takes 50 ms, just when much is going on. And Python collects when
many objects are new, which is in the longest turns: those would take twice as long.
"""

import asyncio
import ctypes
import gc
import time
from collections.abc import Callable
from contextlib import suppress

_AFTER = (700, 7_000, 21_000)
"""New objects since the last collection of each generation, above which the next tick begins one.
Roughly as with Python's own thresholds, but all of them have looked at once after 21,000."""
_AT_THE_LATEST = 50_000
"""New objects, above which Python does not wait for a tick."""
_FULL = 2
_GROWTH = 1.5
_COUNTED_EVERY_S = 600.0
"""Counting what is frozen takes some milliseconds for a large robot."""


class Heap:
    """Freezes what has survived a full collection, so that the next one looks only at what is new.

    What is frozen is still released by its reference counts. Objects that refer to each other and
    become garbage once they are frozen would stay; those of connections do not, since they are
    parted when these end. Others would make what is frozen grow: by half, and all is looked at
    again, which costs one long collection instead of memory without bound.
    """

    def __init__(self, monotonic: Callable[[], float] = time.monotonic) -> None:
        """Prepare; nothing is frozen before `settle`.

        Args:
            monotonic: Returns the time, s.
        """
        self._monotonic = monotonic
        self._count_at = 0.0
        self._frozen = 0
        """Objects that were frozen when all had been looked at."""
        self._is_thawed = False
        self._new = [0, 0, 0]
        """New objects between the last collection of each generation and the last one of all."""

    def settle(self) -> None:
        """Begin: freeze all that exists now, and from now on what survives a full collection."""
        gc.set_threshold(_AT_THE_LATEST, 1, 1)
        gc.callbacks.append(self.follow)
        self._is_thawed = True
        gc.collect()
        # Python waits with the next one until a quarter of the survivors of this one is new.
        gc.collect()
        _give_back_freed_memory()

    def note_tick(self, _since_s: float) -> None:
        """Collect in a turn of its own, if that is due: called by the tick, which comes first."""
        young = gc.get_count()[0]
        due = [number for number, most in enumerate(_AFTER) if self._new[number] + young > most]
        if due:
            asyncio.get_running_loop().call_soon(gc.collect, due[-1])

    def follow(self, phase: str, info: dict[str, int]) -> None:
        """Before a full collection, thaw if much is frozen; after it, freeze. Called by Python."""
        if phase == "start":
            young = gc.get_count()[0]
            for number in range(len(self._new)):
                self._new[number] = 0 if number <= info["generation"] else self._new[number] + young
        if info["generation"] != _FULL:
            return
        if phase == "start":
            self._is_thawed = self._is_thawed or self._thaw()
            return
        gc.freeze()
        if self._is_thawed:
            self._is_thawed = False
            self._frozen = gc.get_freeze_count()
            self._count_at = self._monotonic() + _COUNTED_EVERY_S

    def _thaw(self) -> bool:
        """Thaw everything if that has grown too much; return whether it has."""
        now = self._monotonic()
        if now < self._count_at:
            return False
        self._count_at = now + _COUNTED_EVERY_S
        if gc.get_freeze_count() <= _GROWTH * self._frozen:
            return False
        gc.unfreeze()
        return True


def _give_back_freed_memory() -> None:
    """Give pages that hold nothing any more back to the system: 3 MB after a start.

    The C library keeps them otherwise, between what is still in use. Only that of GNU can do this.
    """
    with suppress(AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
