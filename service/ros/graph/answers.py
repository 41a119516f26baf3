"""Waits for the response to a request, of which a stall of our own must lose none."""

import asyncio
from typing import TypeVar

_LATE_S = 0.05
"""A timer that expires later than this did so since the event loop was late."""
_GRACE_S = 0.05
"""Time in which threads hand over what arrived during a stall."""

AnswerT = TypeVar("AnswerT")


async def answer_within(answer: "asyncio.Future[AnswerT]", within_s: float) -> AnswerT:
    """Return the result of a future.

    `asyncio.timeout` would drop a result that comes in the same turn of the loop as the timeout.

    Args:
        answer: Set on the event loop's thread.
        within_s: Time that it may take, s; a loop that was late then waits a little longer.

    Raises:
        TimeoutError: There was no result in time.
    """
    loop = asyncio.get_running_loop()
    ends_at = loop.time() + within_s
    await asyncio.wait((answer,), timeout=within_s)
    if not answer.done() and loop.time() - ends_at > _LATE_S:
        await asyncio.wait((answer,), timeout=_GRACE_S)
    if not answer.done():
        raise TimeoutError
    return answer.result()
