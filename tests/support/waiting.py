"""Waiting for what another task or process does, without saying for how long."""

import asyncio
from collections.abc import Awaitable, Callable

PATIENCE_S = 10.0


async def until(
    condition: Callable[[], bool] | Callable[[], Awaitable[bool]], pause_s: float = 0
) -> None:
    """Let others run until a condition holds.

    Args:
        condition: A function, or one that returns a coroutine.
        pause_s: Between two looks; 0 lets the tasks of this process take a turn.

    Raises:
        TimeoutError: It never did.
    """
    async with asyncio.timeout(PATIENCE_S):
        # Polled, since what is waited for knows nothing of this test.
        while not await _holds(condition):  # noqa: ASYNC110
            await asyncio.sleep(pause_s)


async def _holds(condition: Callable[[], bool] | Callable[[], Awaitable[bool]]) -> bool:
    found = condition()
    return found if isinstance(found, bool) else await found
