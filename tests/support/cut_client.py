"""A client of the events whose connection is cut again and again, and that goes on by id."""

import asyncio
import json
from random import Random
from typing import Any

import websockets

from tests.support.process import connect

_PATIENCE_S = 5.0


class CutClient:
    """Has each event that it was ever told, and each gap.

    Args:
        chance: Decides after how many events the next cut is.
    """

    def __init__(self, chance: Random) -> None:
        self.events: list[dict[str, Any]] = []
        self.gaps: list[tuple[int, int]] = []
        self.cuts = 0
        self._chance = chance
        self._place = ""
        """From where it goes on, as a query."""
        self._next = 1

    async def follow(self, stream_url: str, cuts: int) -> None:
        """Be cut so many times."""
        for _ in range(cuts):
            async with connect(f"{stream_url}?topics=events{self._place or '&after=0'}") as stream:
                await self._read(stream, self._chance.choice((0, 1, 2, 5, 100)))
                stream.transport.abort()
            self.cuts += 1

    async def follow_to(self, stream_url: str, newest: int) -> None:
        """Read up to an event, without a cut."""
        async with connect(f"{stream_url}?topics=events{self._place}") as stream:
            await self._read(stream, newest + 1 - self._next, newest)

    async def _read(
        self, stream: websockets.ClientConnection, count: int, newest: int | None = None
    ) -> None:
        """Read some events, and whatever comes with them."""
        while count > 0 and (newest is None or self._next <= newest):
            try:
                frame = json.loads(await asyncio.wait_for(stream.recv(), _PATIENCE_S))
            except websockets.ConnectionClosed:
                return
            if frame["type"] == "event":
                count -= 1
                self._take(frame)
            elif frame["type"] == "gap":
                assert frame["from"] == self._next, (frame, self._next)
                self.gaps.append((frame["from"], frame["to"]))
                self._next = frame["to"] + 1

    def _take(self, event: dict[str, Any]) -> None:
        assert event["id"] == self._next, (event, self._next)
        self.events.append(event)
        self._next = event["id"] + 1
        self._place = f"&after={event['id']}&epoch={event['epoch']}"
