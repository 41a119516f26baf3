"""Writes frames and events to all stream clients: encoded once, framed once, in one loop.

Nothing is queued for a client. Clients in step get the same bytes. A client that has not yet read
what was written before is passed over: it skips frames, and does not delay the others.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager

from websockets.frames import Close, CloseCode, Frame, Opcode

from api.streaming.catching_up import CatchingUp
from api.streaming.client_input import StreamQuery
from api.streaming.cursor import Cursor, FrameBytes
from api.streaming.encoder import StreamEncoder
from api.streaming.stream_client import Group, StreamClient
from api.streaming.websocket_frames import PING, Connection
from domain.timebase import Instant, seconds
from service.clock import Clock
from service.history.event_history import EventHistory
from service.history.event_pages import EventPages
from service.supervisor import Supervisor

log = logging.getLogger(__name__)

PING_EVERY = seconds(1.1)
"""A client that has not answered a ping when the next one is due is slow."""
ANSWER_WITHIN = seconds(0.5)
"""So are a few whose answer takes longer. It must be seen soon: a library that has taken some
messages reads no more until most of them are used, and then all that has come meanwhile, so that
its answers come ever later."""
_ON_TIME = seconds(0.2)
"""If we are later than that, answers may wait for us."""
_CLIENTS_AT_ONCE = 100
"""Clients written to before other tasks of the event loop run: about 1 ms."""
_BYTES_AT_ONCE = 131_072
"""As `_CLIENTS_AT_ONCE`, for long histories of events and large frames."""
_REFRESH_SHARE = 200
"""At most one in so many clients gets a complete frame for its age in one turn."""
_CLOSE = Frame(Opcode.CLOSE, Close(CloseCode.POLICY_VIOLATION, "you do not read").serialize())
_CLOSING_S = 1.0


class FanOut:
    """The clients, and the task that writes to them, which runs while there are any."""

    def __init__(
        self, supervisor: Supervisor, encoder: StreamEncoder, history: EventHistory, clock: Clock
    ) -> None:
        """Begin without clients.

        Args:
            supervisor: Whose frames are written.
            encoder: Makes their text.
            history: Has its events.
            clock: For what clients are due; not that of the robot, if this was recorded.
        """
        self.skipped = 0
        """Frames skipped so far, of all clients."""
        self.dropped = 0
        """Clients dropped so far because they did not read."""
        self._supervisor = supervisor
        self._encoder = encoder
        self._pages = EventPages(history)
        self._catching_up = CatchingUp(clock, self._wake)
        self._groups: dict[frozenset[str], Group] = {}
        self._clock = clock
        self._ping_at = clock.now() + PING_EVERY
        self._answers_due: Instant | None = None
        """When those who have not answered the last ping are slow; None: that was judged."""
        self._aged: deque[StreamClient] = deque()
        """Clients that are due for a complete frame; those that left meanwhile stay for a while."""
        self._woken = asyncio.Event()
        self._task: asyncio.Task[None] | None = None
        self._owing_since: Instant | None = None

    def owing_since(self) -> Instant | None:
        """Return since when nothing was written although there is something; None: there is not.

        After a failure it stays until all clients there are have been written to again.
        """
        return self._owing_since

    @contextmanager
    def serve(
        self, connection: Connection, query: StreamQuery, address: str
    ) -> Iterator[StreamClient]:
        """Write to a client while the context is open.

        Args:
            connection: An accepted connection.
            query: The request of the client.
            address: Of the client, for the log.
        """
        group = self._groups.get(query.topics)
        if group is None:
            group = Group(self._cursor_from_now_on(query.topics))
            self._groups[query.topics] = group
        cursor = Cursor(self._supervisor, self._pages, query)
        client = StreamClient(group, connection.transport, cursor, address, self._clock)
        group.add(client)
        connection.listen(client)
        self._wake()
        if self._task is None:
            self._task = asyncio.create_task(self._run(), name="stream fan-out")
            self._task.add_done_callback(self._ended)
        try:
            yield client
        finally:
            connection.listen(None)
            group.remove(client)
            if client.cursor.events is not None:
                self._catching_up.forget(client.cursor.events)
            if group.is_empty and self._groups.get(query.topics) is group:
                del self._groups[query.topics]
            if not self._groups and self._task is not None:
                self._task.cancel()
                self._task = self._owing_since = None

    def resync(self, client: StreamClient) -> None:
        """Send a complete frame to one client next."""
        client.resync()
        self._wake()

    def drop(self, transport: asyncio.WriteTransport, address: str) -> None:
        """Disconnect a client that does not read; the close frame reaches it if it reads on."""
        self.dropped += 1
        log.info("dropped client %s: it does not read", address)
        if not transport.is_closing():
            transport.write(_CLOSE.serialize(mask=False))
            transport.close()
        # What waits for a client is only discarded so.
        asyncio.get_running_loop().call_later(_CLOSING_S, transport.abort)

    async def _run(self) -> None:
        frames, events = self._supervisor.frames, self._supervisor.events
        with frames.watch(self._wake), events.watch(self._wake):
            while True:
                await self._woken.wait()
                self._woken.clear()
                encoded = FrameBytes(self._encoder)
                ping = self._ping()
                self._refresh_some()
                for group in tuple(self._groups.values()):
                    await self._encoder.prepare(group.cursor.topics)
                    self._keep_up(group)
                    await self._write_in_step(group, encoded, ping)
                    await self._write_apart(group, encoded, ping)
                # Writing to a transport with room never suspends, and a long history takes many
                # rounds: other tasks must run in between.
                await self._let_others_run()
                if not self._woken.is_set():
                    self._owing_since = None

    def _cursor_from_now_on(self, topics: frozenset[str]) -> Cursor:
        return Cursor(self._supervisor, self._pages, StreamQuery(topics, None, None))

    def _keep_up(self, group: Group) -> None:
        """Let all clients continue alone if more happened at once than memory keeps."""
        if group.cursor.events is not None and group.cursor.events.needs_page:
            for client in tuple(group.in_step.values()):
                group.part_from(client)
            group.cursor = self._cursor_from_now_on(group.cursor.topics)

    def _wake(self) -> None:
        self._woken.set()
        if self._owing_since is None:
            self._owing_since = self._clock.now()

    async def _let_others_run(self) -> None:
        """Let other tasks run, after some clients were written to."""
        await asyncio.sleep(0)
        self._owing_since = self._clock.now()

    def _ping(self) -> bytes:
        """Return a ping if one is due, and judge who has answered the last one in time."""
        now = self._clock.now()
        if self._answers_due is not None and now >= self._answers_due:
            is_on_time = now - self._answers_due < _ON_TIME
            self._answers_due = None
            if is_on_time:
                for group in self._groups.values():
                    group.part_from_late()
        if now < self._ping_at:
            return b""
        is_on_time = now - self._ping_at < _ON_TIME
        self._ping_at, self._answers_due = now + PING_EVERY, now + ANSWER_WITHIN
        for group in self._groups.values():
            group.ask_all(judged=is_on_time)
            if not self._aged:
                self._aged += group.due_for_complete(now)
        return PING

    def _refresh_some(self) -> None:
        """Let a few of the clients that are due take a complete frame next."""
        most = 1 + sum(len(group.clients) for group in self._groups.values()) // _REFRESH_SHARE
        for _ in range(min(most, len(self._aged))):
            self._aged.popleft().resync()

    async def _write_in_step(self, group: Group, encoded: FrameBytes, ping: bytes) -> None:
        """Write the same bytes to all clients that have read everything before.

        The innermost loop is the only code that runs per client and frame. A client that cannot
        read all of it leaves the group during the write.
        """
        content, skipped = group.cursor.take(encoded)
        if not content and not ping:
            return
        content += ping
        self._go_on_if_more(group.cursor)
        self.skipped += skipped * len(group.in_step)
        transports = tuple(group.in_step)
        count = min(_CLIENTS_AT_ONCE, 1 + _BYTES_AT_ONCE // len(content))
        for start in range(0, len(transports), count):
            batch = transports[start : start + count]
            if len(group.in_step) < len(transports):
                batch = tuple(filter(group.in_step.__contains__, batch))
            for transport in batch:
                transport.write(content)
            await self._let_others_run()

    async def _write_apart(self, group: Group, encoded: FrameBytes, ping: bytes) -> None:
        """Write to each of the other clients what it lacks; then it may rejoin the group."""
        now = self._clock.now()
        written = 0
        for number, client in enumerate(tuple(group.apart.values()), 1):
            if client.is_ready(now):
                content, skipped = client.cursor.take(encoded)
                self.skipped += skipped
                written += len(content)
                if content or ping:
                    client.transport.write(content + (PING if client.is_slow else ping))
                    if client.is_slow:
                        client.note_asked(skipped)
                if client.cursor.took_complete:
                    client.note_complete(len(content))
                self._go_on_if_more(client.cursor)
                group.take_in_if_level(client)
            elif client.is_stuck(now):
                group.remove(client)
                self.drop(client.transport, client.address)
            if number % _CLIENTS_AT_ONCE == 0 or written >= _BYTES_AT_ONCE:
                written = 0
                await self._let_others_run()

    def _go_on_if_more(self, cursor: Cursor) -> None:
        if cursor.has_events:
            self._wake()
        elif cursor.events is not None and cursor.events.needs_page:
            self._catching_up.ask(cursor.events)

    def _ended(self, task: asyncio.Task[None]) -> None:
        """Disconnect all clients if the task failed: a silent connection would mislead them."""
        if task.cancelled():
            return
        log.critical("the fan-out failed", exc_info=task.exception())
        self._task = None
        self.disconnect_all()

    def disconnect_all(self) -> None:
        """Disconnect all clients; they may come again at once."""
        for group in self._groups.values():
            for client in group.clients:
                client.transport.abort()
