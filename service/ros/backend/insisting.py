"""Requests that got lost: asked again once the node shows that it never took them.

DDS connects the ends of a service one after the other. A node that has just appeared may be found
before it can hear us, or its response may not find its way back, and neither side is told.
"""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from enum import Enum
from typing import Any, TypeVar

from domain.timebase import Duration, seconds
from service.clock import Clock

MAX_CALLS = 3
"""So often the same is asked at most."""
PATIENCE: Duration = seconds(0.6)
"""So long an answer may take before the node is looked at."""
WINDOW: Duration = seconds(1.5)
"""Later nothing is asked again: whoever asked may have given up by then. The core waits 2 s for
parameters, and longer for transitions."""

ResultT = TypeVar("ResultT")


class Seen(Enum):
    """What a node shows of a request that it has not answered."""

    DONE = "done"
    LOST = "lost"
    UNCLEAR = "unclear"
    """It is at it, or says nothing at all, or must not be asked again."""


async def insist(
    ask: Callable[[], Coroutine[Any, Any, ResultT]],
    see: Callable[[], Awaitable[Seen]],
    done: ResultT,
    clock: Clock,
) -> ResultT:
    """Ask a node for something that does no harm twice, and return its answer.

    Args:
        ask: Asks and returns the answer.
        see: Looks what became of it; TimeoutError: the node does not say.
        done: The answer when it is seen to be done.
        clock: The present.

    Raises:
        TimeoutError: As of `ask`.
    """
    calls, ends_at = {asyncio.create_task(ask())}, clock.now() + WINDOW
    try:
        while len(calls) < MAX_CALLS and clock.now() < ends_at:
            answered = await _first_of(calls, clock)
            if answered is not None:
                return answered.result()
            seen = await _look(see)
            if seen is Seen.DONE:
                return done
            if seen is Seen.LOST and clock.now() < ends_at:
                calls.add(asyncio.create_task(ask()))
        ended, _ = await asyncio.wait(calls, return_when=asyncio.FIRST_COMPLETED)
        return ended.pop().result()
    finally:
        for call in calls:
            call.cancel()
        await asyncio.gather(*calls, return_exceptions=True)


async def _look(see: Callable[[], Awaitable[Seen]]) -> Seen:
    try:
        return await see()
    except TimeoutError:
        return Seen.UNCLEAR


async def _first_of(
    calls: set[asyncio.Task[ResultT]], clock: Clock
) -> asyncio.Task[ResultT] | None:
    """Return a call that was answered; None: there was none for as long as one is patient."""
    timer = asyncio.ensure_future(clock.sleep_until(clock.now() + PATIENCE))
    try:
        await asyncio.wait({*calls, timer}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        timer.cancel()
        await asyncio.gather(timer, return_exceptions=True)
    return next((call for call in calls if call.done()), None)
