"""Keeps garbage collections from delaying the event loop.

The old generation of a large robot takes 100 ms and more to scan, and Python would scan it whenever
many objects were made, which is just when a large change is under way. Nearly all objects are freed
by their reference counts; the cycles that grew old are collected while the vehicle stands.
"""

import gc

from domain.snapshot import SystemState
from domain.supervision import Supervision
from domain.timebase import seconds
from service.clock import Clock

LOOK_EVERY = seconds(60)
COLLECT_AFTER = 200
"""Collections of the young generations, about a million new objects, after which the old one is
collected while the vehicle stands."""
COLLECT_IN_ANY_CASE = 50 * COLLECT_AFTER
_YOUNG, _MIDDLE = 700, 10
"""Python's own thresholds."""
_NEVER = 2**31 - 1


def settle_heap() -> None:
    """Never scan the objects that exist now, and leave the old ones to `collect_at_rest`."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(_YOUNG, _MIDDLE, _NEVER)


async def collect_at_rest(core: Supervision, clock: Clock) -> None:
    """Collect the old generation while the vehicle stands, until cancelled."""
    while True:
        await clock.sleep_until(clock.now() + LOOK_EVERY)
        grown = gc.get_count()[2]
        stands = core.system_state().state is not SystemState.RUNNING
        if grown >= COLLECT_IN_ANY_CASE or (stands and grown >= COLLECT_AFTER):
            gc.collect()
