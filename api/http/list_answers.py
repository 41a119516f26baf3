"""Long lists, encoded without blocking the event loop."""

import asyncio
from collections.abc import Iterable

from fastapi import Response

_CHARACTERS_AT_ONCE = 32_768
"""About 1 ms of work, after which other tasks of the event loop run."""


async def json_list(texts: Iterable[str]) -> Response:
    """Return `{"items": [...]}`.

    Args:
        texts: The JSON text of each item; consumed one by one.
    """
    return Response(f'{{"items":[{await joined(texts)}]}}', media_type="application/json")


async def joined(texts: Iterable[str]) -> str:
    """Return texts with commas between them.

    Args:
        texts: Consumed one by one; other tasks of the event loop run in between.
    """
    made: list[str] = []
    characters = 0
    for text in texts:
        made.append(text)
        characters += len(text)
        if characters >= _CHARACTERS_AT_ONCE:
            characters = 0
            await asyncio.sleep(0)
    return ",".join(made)
