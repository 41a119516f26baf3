"""Keeps garbage collections from holding up the event loop.

Each full collection looks at every object that is not frozen. The events alone are tens of
thousands after a while, which takes 50 ms, just when much is going on.
"""

import gc
import time
from collections.abc import Callable

_YOUNG, _MIDDLE = 700, 10
"""Python's own thresholds."""
_OLD = 3
"""Collections of the middle generation, after which all that is not frozen is looked at: some
20,000 new objects. Python's own 10 would make each of these longer."""
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

    def settle(self) -> None:
        """Begin: freeze all that exists now, and from now on what survives a full collection."""
        gc.set_threshold(_YOUNG, _MIDDLE, _OLD)
        gc.callbacks.append(self.follow)
        self._is_thawed = True
        gc.collect()
        # Python waits with the next one until a quarter of the survivors of this one is new.
        gc.collect()

    def follow(self, phase: str, info: dict[str, int]) -> None:
        """Before a full collection, thaw if much is frozen; after it, freeze. Called by Python."""
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
