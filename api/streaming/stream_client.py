"""Stream clients: those in step are written to together, the others one by one."""

import asyncio

from api.streaming.cursor import Cursor
from domain.timebase import Instant, seconds
from service.clock import Clock

PATIENCE = seconds(4.5)
"""A client with waiting data that shows no sign of reading for this long is dropped."""


class Group:
    """The clients with the same topics."""

    def __init__(self, cursor: Cursor) -> None:
        self.cursor = cursor
        """Position of all clients in step."""
        self.in_step: dict[asyncio.WriteTransport, StreamClient] = {}
        """Clients that have read everything so far, by transport."""
        self.apart: dict[asyncio.WriteTransport, StreamClient] = {}
        """The other clients."""

    @property
    def clients(self) -> tuple["StreamClient", ...]:
        """Return all clients."""
        return (*self.in_step.values(), *self.apart.values())

    @property
    def is_empty(self) -> bool:
        """Tell whether there is no client."""
        return not self.in_step and not self.apart

    def add(self, client: "StreamClient") -> None:
        """Add a client that has received nothing yet."""
        self.apart[client.transport] = client

    def remove(self, client: "StreamClient") -> None:
        """Remove a client; it may be removed already."""
        self.in_step.pop(client.transport, None)
        self.apart.pop(client.transport, None)

    def part_from(self, client: "StreamClient") -> None:
        """Let a client that cannot read more continue alone, from the position of the group."""
        if self.in_step.pop(client.transport, None) is not None:
            client.cursor = self.cursor.copy()
            self.apart[client.transport] = client

    def take_in_if_level(self, client: "StreamClient") -> None:
        """Let a client that has received and read everything rejoin the others."""
        has_all = client.cursor.position == self.cursor.position
        has_taken = not client.transport.get_write_buffer_size()
        # It may have disconnected during the write.
        if has_all and has_taken and self.apart.pop(client.transport, None) is not None:
            self.in_step[client.transport] = client

    def take_silent(self) -> tuple["StreamClient", ...]:
        """Remove and return the clients that missed a ping; the others must answer the next one.

        Clients with waiting data may not have received the ping yet; see `StreamClient.is_stuck`.
        """
        free = [c for c in self.clients if not c.transport.get_write_buffer_size()]
        silent = tuple(client for client in free if client.owes_answer)
        for client in silent:
            self.remove(client)
        for client in free:
            client.owes_answer = True
        return silent


class StreamClient:
    """One client; its connection notifies it of congestion, pongs and loss."""

    def __init__(
        self,
        group: Group,
        transport: asyncio.WriteTransport,
        cursor: Cursor,
        address: str,
        clock: Clock,
    ) -> None:
        self.transport = transport
        self.cursor = cursor
        """Its own position, while it is apart."""
        self.address = address
        self.owes_answer = False
        """Whether it has not answered the last ping."""
        self._group = group
        self._clock = clock
        self._waiting = 0
        self._read_at = clock.now()
        """Time of its last sign of reading."""

    def clogged(self) -> None:
        """Continue alone, until the data that was written last has been read."""
        self._group.part_from(self)

    def resync(self) -> None:
        """Continue alone, with a complete frame."""
        self._group.part_from(self)
        self.cursor.begin_frames_anew()

    def answered(self) -> None:
        """Note that the client answered a ping, and so reads."""
        self.owes_answer = False
        self._read_at = self._clock.now()

    def lost(self) -> None:
        """Write no more."""
        self._group.remove(self)

    def is_ready(self, now: Instant) -> bool:
        """Tell whether all earlier data was sent, and more can be written."""
        waiting = self.transport.get_write_buffer_size()
        if waiting == 0 or waiting < self._waiting:
            self._read_at = now
        self._waiting = waiting
        return waiting == 0 and not self.transport.is_closing()

    def is_stuck(self, now: Instant) -> bool:
        """Tell whether it has neither read waiting data nor answered a ping for `PATIENCE`."""
        return now - self._read_at > PATIENCE and not self.transport.is_closing()
