"""What a client of rosbridge said and was not done yet, and what of it cannot wait."""

import asyncio
from collections import deque
from collections.abc import Mapping
from typing import Any

MAX_CHARACTERS = 256 * 1_024
"""So much of one client is read ahead: as much as the network hands over at once."""
_OVERHEAD = 100
"""Of a message, so that small ones are bounded as well."""
_URGENT_CHARACTERS = 1_000


class ReadAhead:
    """Messages in their order; reading stops while there are too many."""

    def __init__(self) -> None:
        self._messages: deque[Mapping[str, Any]] = deque()
        self._characters = 0
        self._changed = asyncio.Event()

    async def put(self, message: Mapping[str, Any]) -> None:
        """Add a message, once there is room for it."""
        while self._characters > MAX_CHARACTERS:
            self._changed.clear()
            await self._changed.wait()
        self._messages.append(message)
        self._characters += _length(message)
        self._changed.set()

    async def get(self) -> Mapping[str, Any]:
        """Return the next message, once there is one."""
        while not self._messages:
            self._changed.clear()
            await self._changed.wait()
        message = self._messages.popleft()
        self._characters -= _length(message)
        self._changed.set()
        return message


def is_urgent(message: Mapping[str, Any]) -> bool:
    """Tell, without reading all of it, whether a message may be a reading of the emergency stop."""
    text = message.get("text")
    if not isinstance(text, str) or len(text) > _URGENT_CHARACTERS:
        return False
    return "publish" in text and "estop" in text


def _length(message: Mapping[str, Any]) -> int:
    return len(message.get("text") or message.get("bytes") or "") + _OVERHEAD
