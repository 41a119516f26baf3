"""Waits at the end of the service until the vehicle stands, before programs of nodes are ended."""

import asyncio
from contextlib import suppress

from service.supervisor import Supervisor

STANDS_WITHIN_S = 5.0
"""A vehicle that still moves then does not wait for these programs to stop it."""

_LOOK_EVERY_S = 0.05


async def until_it_stands(supervisor: Supervisor, within_s: float = STANDS_WITHIN_S) -> None:
    """Return once the vehicle has stopped as far as is known, or when the time is over.

    Args:
        supervisor: Was told to stop driving, and still runs.
        within_s: The longest wait, in seconds.
    """
    watch = supervisor.core.driving.watch
    with suppress(TimeoutError):
        async with asyncio.timeout(within_s):
            # Polled, since reports of the vehicle come 20 times a second anyway.
            while watch.moves:  # noqa: ASYNC110
                await asyncio.sleep(_LOOK_EVERY_S)
