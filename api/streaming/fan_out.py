"""Write what is published to all clients of the stream: encoded once, framed once, in one loop.

Nothing is queued for a client. Those in step get the same bytes; one that has not yet taken what
was written before is left out, and so a slow client skips frames, and delays nobody.
"""

import asyncio
import logging
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

from api.streaming.encoder import StreamEncoder
from api.streaming.place import News, Place
from api.streaming.query import StreamQuery
from domain.timebase import Instant, seconds
from service.supervisor import Supervisor

log = logging.getLogger(__name__)

PATIENCE = seconds(4.5)
"""A client that has taken nothing for so long is dropped."""
_CLIENTS_AT_ONCE = 100
"""After so many others get their turn: some 1 ms."""


class FanOut:
    """The clients, and the task that writes to them; it runs as long as there are any."""

    def __init__(self, supervisor: Supervisor, encoder: StreamEncoder) -> None:
        self.skipped = 0
        """Frames that clients missed so far."""
        self.dropped = 0
        """Clients cut off so far because they took nothing."""
        self._supervisor = supervisor
        self._encoder = encoder
        self._groups: dict[frozenset[str], _Group] = {}
        self._woken = asyncio.Event()
        self._task: asyncio.Task[None] | None = None

    @contextmanager
    def serve(
        self, transport: asyncio.WriteTransport, query: StreamQuery, address: str
    ) -> Iterator[None]:
        """Write to a client as long as the context lasts.

        Args:
            transport: Its connection, which is accepted.
            query: What it asked for.
            address: Named in the log.
        """
        now = self._supervisor.clock.now()
        client = _Client(transport, Place(self._supervisor, query), now, address)
        group = self._groups.get(query.topics)
        if group is None:
            from_now_on = StreamQuery(query.topics, None, None)
            group = _Group(Place(self._supervisor, from_now_on))
            self._groups[query.topics] = group
        group.add(client)
        self._woken.set()
        if self._task is None:
            self._task = asyncio.create_task(self._run(), name="stream fan-out")
            self._task.add_done_callback(self._ended)
        try:
            yield
        finally:
            group.remove(client)
            if group.is_empty:
                self._groups.pop(query.topics)
            if not self._groups and self._task is not None:
                self._task.cancel()
                self._task = None

    def drop(self, transport: asyncio.WriteTransport, address: str) -> None:
        """Cut off a client that does not read."""
        self.dropped += 1
        log.info("dropped %s: it does not read", address)
        transport.abort()

    async def _run(self) -> None:
        frames, events = self._supervisor.frames, self._supervisor.events
        with frames.watch(self._woken.set), events.watch(self._woken.set):
            while True:
                await self._woken.wait()
                self._woken.clear()
                news = News(self._encoder)
                for group in tuple(self._groups.values()):
                    await self._prepare(group.place.topics)
                    await self._write_in_step(group, news)
                    await self._write_apart(group, news)

    async def _prepare(self, topics: frozenset[str]) -> None:
        """Encode what is large a few parts at a time, before it is needed all at once."""
        frame = self._supervisor.frames.newest
        if frame is not None:
            await self._encoder.prepare(frame, topics)

    async def _write_in_step(self, group: "_Group", news: News) -> None:
        """Write the same bytes to all who have taken everything before; part from the others.

        Of Python, only the innermost lines run for each client and frame, on the bare transport.
        """
        before = group.place.copy()
        content, skipped = group.place.take(news)
        if not content:
            return
        self._wake_if_more(group.place)
        self.skipped += skipped * len(group.in_step)
        now = self._supervisor.clock.now()
        for transports in _batches(group.in_step):
            for transport in transports:
                if transport.get_write_buffer_size():
                    group.part_from(transport, before, now)
                elif not transport.is_closing():
                    transport.write(content)
            await asyncio.sleep(0)

    async def _write_apart(self, group: "_Group", news: News) -> None:
        """Write to each of the others what it has not got, and take it in once it has it all."""
        now = self._supervisor.clock.now()
        for transports in _batches(group.apart):
            for transport in transports:
                client = group.apart.get(transport)
                if client is not None:
                    self._write_alone(client, news, now)
                    group.take_in_if_level(client)
            await asyncio.sleep(0)

    def _write_alone(self, client: "_Client", news: News, now: Instant) -> None:
        if client.is_ready(now):
            content, skipped = client.place.take(news)
            self.skipped += skipped
            if content:
                client.transport.write(content)
            self._wake_if_more(client.place)
        elif client.is_stuck(now):
            self.drop(client.transport, client.address)

    def _wake_if_more(self, place: Place) -> None:
        if place.has_events:
            self._woken.set()

    def _ended(self, task: asyncio.Task[None]) -> None:
        """Cut all clients off when the task has failed: a silent connection would deceive them."""
        if task.cancelled():
            return
        log.critical("the fan-out failed", exc_info=task.exception())
        self._task = None
        for group in self._groups.values():
            for transport in (*group.in_step, *group.apart):
                transport.abort()


class _Client:
    """One client, with its own place while it is apart from the others."""

    def __init__(
        self, transport: asyncio.WriteTransport, place: Place, now: Instant, address: str
    ) -> None:
        self.transport = transport
        self.place = place
        self.address = address
        self._moved_at = now
        self._waiting = 0

    def is_ready(self, now: Instant) -> bool:
        """Tell whether everything written before is on its way, and more can be written."""
        waiting = self.transport.get_write_buffer_size()
        if waiting == 0 or waiting < self._waiting:
            self._moved_at = now
        self._waiting = waiting
        return waiting == 0 and not self.transport.is_closing()

    def is_stuck(self, now: Instant) -> bool:
        """Tell whether it has taken nothing for too long."""
        return now - self._moved_at > PATIENCE and not self.transport.is_closing()

    def go_on_from(self, place: Place, now: Instant) -> None:
        """Begin a way of its own."""
        self.place = place
        self._moved_at = now


class _Group:
    """The clients that asked for the same topics, by transport."""

    def __init__(self, place: Place) -> None:
        self.place = place
        """Where all are who are in step."""
        self.in_step: dict[asyncio.WriteTransport, _Client] = {}
        self.apart: dict[asyncio.WriteTransport, _Client] = {}

    @property
    def is_empty(self) -> bool:
        """Tell whether there is no client."""
        return not self.in_step and not self.apart

    def add(self, client: _Client) -> None:
        """Take a client that has got nothing yet."""
        self.apart[client.transport] = client

    def part_from(self, transport: asyncio.WriteTransport, place: Place, now: Instant) -> None:
        """Let a client that is not ready go on from `place` alone; it may have gone meanwhile."""
        client = self.in_step.pop(transport, None)
        if client is not None:
            client.go_on_from(place.copy(), now)
            self.apart[transport] = client

    def take_in_if_level(self, client: _Client) -> None:
        """Let a client that has got everything go on with the others."""
        if client.place.position == self.place.position:
            self.in_step[client.transport] = self.apart.pop(client.transport)

    def remove(self, client: _Client) -> None:
        """Forget a client that went."""
        self.in_step.pop(client.transport, None)
        self.apart.pop(client.transport, None)


def _batches(
    clients: Iterable[asyncio.WriteTransport],
) -> Iterator[tuple[asyncio.WriteTransport, ...]]:
    """Yield the clients that there are now, in batches; meanwhile some may come or go."""
    everybody = tuple(clients)
    for start in range(0, len(everybody), _CLIENTS_AT_ONCE):
        yield everybody[start : start + _CLIENTS_AT_ONCE]
