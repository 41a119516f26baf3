"""Links between computers that run in a test, and note what is delivered."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import Self

from domain.computers import ComputerName
from service.link.port import Link, LinkCounts

_PATIENCE_S = 10.0
_PROBES = {b"probe beat": True, b"probe message": False}
"""And whether they may be lost."""
_PROBE_EVERY_S = 0.02


class RunningLink:
    """A link that runs as long as the context lasts."""

    def __init__(self, name: ComputerName, link: Link) -> None:
        self.name = name
        self.link = link
        self.received: list[tuple[ComputerName, bytes]] = []
        """What was delivered, without the probes of `reach`."""
        self.when_heard: Callable[[ComputerName, bytes], None] = lambda _sender, _message: None
        """Called with each message, after it was noted."""
        self.task: asyncio.Task[None]
        self.probed_by: set[tuple[ComputerName, bytes]] = set()
        """Whose probes were heard."""
        self._more = asyncio.Event()

    async def __aenter__(self) -> Self:
        self.task = asyncio.create_task(self.link.run(self._take), name=f"link of {self.name}")
        await asyncio.sleep(0)
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.stop()

    async def stop(self) -> None:
        """End the link."""
        self.task.cancel()
        with suppress(asyncio.CancelledError):
            await self.task

    def send(self, to: ComputerName, message: bytes, *, may_be_lost: bool = False) -> None:
        """Send a message."""
        self.link.send(to, message, may_be_lost=may_be_lost)

    async def reach(self, other: "RunningLink") -> None:
        """Return once the other one hears both kinds of messages of this one."""
        probes = {(self.name, probe) for probe in _PROBES}
        other.probed_by -= probes
        async with asyncio.timeout(_PATIENCE_S):
            while not probes <= other.probed_by:
                for probe, may_be_lost in _PROBES.items():
                    self.send(other.name, probe, may_be_lost=may_be_lost)
                with suppress(TimeoutError):
                    async with asyncio.timeout(_PROBE_EVERY_S):
                        await other.news()

    async def hear(self, count: int) -> list[tuple[ComputerName, bytes]]:
        """Return what was delivered, once that are so many messages."""
        async with asyncio.timeout(_PATIENCE_S):
            while len(self.received) < count:
                await self.news()
        return self.received

    async def hear_last(self, message: bytes) -> list[bytes]:
        """Return the messages that were delivered, once this one was; without it."""
        async with asyncio.timeout(_PATIENCE_S):
            while message not in (heard := [heard for _, heard in self.received]):
                await self.news()
        return [other for other in heard if other != message]

    @property
    def counts(self) -> LinkCounts:
        """What was dropped."""
        return self.link.counts()

    async def news(self) -> None:
        """Wait until anything more is delivered."""
        self._more.clear()
        await self._more.wait()

    def _take(self, sender: ComputerName, message: bytes) -> None:
        self._more.set()
        if message in _PROBES:
            self.probed_by.add((sender, message))
        else:
            self.received.append((sender, message))
            self.when_heard(sender, message)
