"""Repeats requests that were lost, once it is clear that the node never received them.

DDS connects the ends of a service one after the other. A node that has just appeared may be
discovered before it can receive our requests, or its response may get lost, and neither side is
notified.
"""

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from enum import Enum
from typing import Any, TypeVar

from domain.timebase import Duration, seconds
from service.clock import Clock

MAX_CALLS = 3
"""A request is sent at most this often."""
PATIENCE: Duration = seconds(0.6)
"""After this time without a response, the node is queried for the effect of the request."""
WINDOW: Duration = seconds(1.5)
"""No request is repeated later than this, since the sender may have given up by then. The core
waits 2 s for parameters, and longer for transitions."""

ResultT = TypeVar("ResultT")


class Seen(Enum):
    """What became of a request without a response."""

    DONE = "done"
    LOST = "lost"
    UNCLEAR = "unclear"
    """The node is still processing it, does not respond, or must not get it again."""


async def call_with_retries(
    ask: Callable[[], Coroutine[Any, Any, ResultT]],
    see: Callable[[], Awaitable[Seen]],
    done: ResultT,
    clock: Clock,
) -> ResultT:
    """Send an idempotent request, repeat it if it was lost, and return the response.

    Args:
        ask: Sends the request and returns the response.
        see: Finds out what became of it; TimeoutError: the node does not respond.
        done: Returned if the request turns out to have been carried out.
        clock: Of the service.

    Raises:
        TimeoutError: Raised by `ask`.
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
    """Return the first call with a response; None: there was none within `PATIENCE`."""
    timer = asyncio.ensure_future(clock.sleep_until(clock.now() + PATIENCE))
    try:
        await asyncio.wait({*calls, timer}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        timer.cancel()
        await asyncio.gather(timer, return_exceptions=True)
    return next((call for call in calls if call.done()), None)
