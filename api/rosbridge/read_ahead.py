"""Messages of a rosbridge client that wait to be processed, and those that must not wait."""

import asyncio
import re
from collections import OrderedDict, deque
from collections.abc import Mapping
from typing import Any

from api.http.stop_asked import may_ask_rosbridge

MAX_CHARACTERS = 256 * 1_024
"""Characters that are read ahead per client: as much as the network delivers at once."""
_OVERHEAD = 100
"""Characters counted per message, so that the number of small ones is bounded as well."""
_URGENT_CHARACTERS = 1_000
_REPLACED_AT_ONCE = 50
"""Messages replaced in one turn of the loop, about 1 ms of work."""
_PUBLISH = re.compile(r'"op"\s*:\s*"publish"')
_TOPIC = re.compile(r'"topic"\s*:\s*"([^"\\]{1,256})"')


class ReadAhead:
    """Queue of messages; reading stops while it is full.

    While it is full, a message that publishes replaces the oldest one that waits and publishes to
    the same topic, as with the bounded queue of a ROS subscriber. So a client that publishes faster
    than its messages are processed cannot hold up its own stop.
    """

    def __init__(self) -> None:
        self._waiting: OrderedDict[int, Mapping[str, Any]] = OrderedDict()
        """By number, which counts all messages of the client in order of arrival."""
        self._published: dict[str, deque[int]] = {}
        """Messages that a newer one may replace, by topic as it was written, the oldest first."""
        self._characters = 0
        self._number = 0
        self._replaced = 0
        self._overtaken = 0
        """Number of the last message that a stop has overtaken."""
        self._changed = asyncio.Event()

    @property
    def arrived(self) -> int:
        """Return how many messages were added so far."""
        return self._number

    async def put(self, message: Mapping[str, Any]) -> None:
        """Add a message, after waiting for room."""
        topic = _topic_of(message)
        while self._characters > MAX_CHARACTERS:
            published = self._published.get(topic) if topic is not None else None
            if published:
                self._take(published[0])
                self._replaced += 1
                if self._replaced % _REPLACED_AT_ONCE == 0:
                    # Messages that came together are available at once: others must run in between.
                    await asyncio.sleep(0)
            else:
                self._changed.clear()
                await self._changed.wait()
        self._number += 1
        self._waiting[self._number] = message
        if topic is not None:
            self._published.setdefault(topic, deque()).append(self._number)
        self._characters += _length(message)
        self._changed.set()

    async def get(self) -> tuple[Mapping[str, Any], int]:
        """Wait for the next message, and return it with its number."""
        while not self._waiting:
            self._changed.clear()
            await self._changed.wait()
        number = next(iter(self._waiting))
        message = self._take(number)
        self._changed.set()
        return message, number

    def overtake(self) -> None:
        """Note that a stop is processed before all messages that were added."""
        self._overtaken = self._number

    def is_overtaken(self, number: int) -> bool:
        """Tell whether a stop that came later was processed before a message."""
        return number <= self._overtaken

    def _take(self, number: int) -> Mapping[str, Any]:
        """Remove and return a message, the oldest of all or of its topic."""
        message = self._waiting.pop(number)
        self._characters -= _length(message)
        topic = _topic_of(message)
        if topic is not None:
            published = self._published[topic]
            published.popleft()
            if not published:
                del self._published[topic]
        return message


def is_urgent(message: Mapping[str, Any]) -> bool:
    """Tell, without parsing it, whether a message may ask for a stop over the topic of the e-stop.

    One that releases it waits like any other: ten thousand of them must not delay a stop.
    """
    text = message.get("text")
    if not isinstance(text, str) or len(text) > _URGENT_CHARACTERS:
        return False
    return may_ask_rosbridge(text)


def _topic_of(message: Mapping[str, Any]) -> str | None:
    """Return the topic that a message publishes to; None: none, or it may ask for a stop."""
    text = message.get("text")
    if not isinstance(text, str) or _PUBLISH.search(text) is None or may_ask_rosbridge(text):
        return None
    found = _TOPIC.search(text)
    return found[1] if found else None


def _length(message: Mapping[str, Any]) -> int:
    return len(message.get("text") or message.get("bytes") or "") + _OVERHEAD
