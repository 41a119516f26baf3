"""Messages of a rosbridge client that wait to be processed, and those that must not wait."""

import asyncio
from collections import deque
from collections.abc import Mapping
from typing import Any

MAX_CHARACTERS = 256 * 1_024
"""Characters that are read ahead per client: as much as the network delivers at once."""
_OVERHEAD = 100
"""Characters counted per message, so that the number of small ones is bounded as well."""
_URGENT_CHARACTERS = 1_000


class ReadAhead:
    """Queue of messages; reading stops while it is full."""

    def __init__(self) -> None:
        self._messages: deque[Mapping[str, Any]] = deque()
        self._characters = 0
        self._changed = asyncio.Event()

    async def put(self, message: Mapping[str, Any]) -> None:
        """Add a message, after waiting for room."""
        while self._characters > MAX_CHARACTERS:
            self._changed.clear()
            await self._changed.wait()
        self._messages.append(message)
        self._characters += _length(message)
        self._changed.set()

    async def get(self) -> Mapping[str, Any]:
        """Wait for the next message and return it."""
        while not self._messages:
            self._changed.clear()
            await self._changed.wait()
        message = self._messages.popleft()
        self._characters -= _length(message)
        self._changed.set()
        return message


def is_urgent(message: Mapping[str, Any]) -> bool:
    """Tell, without parsing it, whether a message may be a reading of the emergency stop."""
    text = message.get("text")
    if not isinstance(text, str) or len(text) > _URGENT_CHARACTERS:
        return False
    return "publish" in text and "estop" in text


def _length(message: Mapping[str, Any]) -> int:
    return len(message.get("text") or message.get("bytes") or "") + _OVERHEAD
