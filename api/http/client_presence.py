"""Work for a client is given up when nobody is left to answer."""

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

from fastapi import Request
from starlette.requests import ClientDisconnect

Result = TypeVar("Result")


async def while_connected(request: Request, work: Coroutine[Any, Any, Result]) -> Result:
    """Return what some work returns; it is cancelled once the client disconnects.

    Args:
        request: Whose body was read, or that has none.
        work: What is to be done.

    Raises:
        ClientDisconnect: The client has gone.
        PilothouseError: Raised by the work.
    """
    working = asyncio.create_task(work, name="work for a client")
    gone = asyncio.create_task(_disconnected(request), name="client gone")
    try:
        await asyncio.wait({working, gone}, return_when=asyncio.FIRST_COMPLETED)
        if not working.done():
            raise ClientDisconnect
        return working.result()
    finally:
        working.cancel()
        gone.cancel()
        await asyncio.gather(working, gone, return_exceptions=True)
        # Its error refers to this frame: the two would be a cycle of garbage.
        del working


async def _disconnected(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass
