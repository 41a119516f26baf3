"""Keeps garbage collections from holding up the event loop.

Each full collection looks at every object that is not frozen. The events alone are tens of
thousands after a while, which takes 50 ms, just when much is going on.
"""

import gc

_YOUNG, _MIDDLE = 700, 10
"""Python's own thresholds."""
_OLD = 3
"""Collections of the middle generation, after which all that is not frozen is looked at: some
20,000 new objects. Python's own 10 would make each of these longer."""


def settle_heap() -> None:
    """Never look at objects again that exist now, or that survive a full collection.

    They are still released by their reference counts. Only objects that refer to each other would
    stay once they are old: those of connections do not, since they are parted when these end.
    """
    gc.set_threshold(_YOUNG, _MIDDLE, _OLD)
    gc.callbacks.append(keep_survivors)
    gc.collect()
    # Python waits with the next one until a quarter of the survivors of this one is new.
    gc.collect()


def keep_survivors(phase: str, info: dict[str, int]) -> None:
    """Freeze what has survived a full collection; called by Python around each collection."""
    if phase == "stop" and info["generation"] == 2:
        gc.freeze()
