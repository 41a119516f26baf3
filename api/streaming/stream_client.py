"""The clients of the stream: together as long as they are in step, and each by itself else."""

import asyncio

from api.streaming.cursor import Cursor
from domain.timebase import Instant, seconds
from service.clock import Clock

PATIENCE = seconds(4.5)
"""A client for which something waits, and that was not seen to read for so long, is dropped."""


class Group:
    """The clients that asked for the same topics."""

    def __init__(self, cursor: Cursor) -> None:
        self.cursor = cursor
        """Where all are who are in step."""
        self.in_step: dict[asyncio.WriteTransport, StreamClient] = {}
        """Those who have taken everything so far, by what is written to."""
        self.apart: dict[asyncio.WriteTransport, StreamClient] = {}
        """Those who have not."""

    @property
    def clients(self) -> tuple["StreamClient", ...]:
        """Return all of them."""
        return (*self.in_step.values(), *self.apart.values())

    @property
    def is_empty(self) -> bool:
        """Tell whether there is no client."""
        return not self.in_step and not self.apart

    def add(self, client: "StreamClient") -> None:
        """Take a client that has got nothing yet."""
        self.apart[client.transport] = client

    def remove(self, client: "StreamClient") -> None:
        """Forget a client; it may be forgotten already."""
        self.in_step.pop(client.transport, None)
        self.apart.pop(client.transport, None)

    def part_from(self, client: "StreamClient") -> None:
        """Let a client that cannot take more go on alone, from where all are now."""
        if self.in_step.pop(client.transport, None) is not None:
            client.cursor = self.cursor.copy()
            self.apart[client.transport] = client

    def take_in_if_level(self, client: "StreamClient") -> None:
        """Let a client that has got and taken everything go on with the others."""
        has_all = client.cursor.position == self.cursor.position
        has_taken = not client.transport.get_write_buffer_size()
        # It may have gone just now, while it was written to.
        if has_all and has_taken and self.apart.pop(client.transport, None) is not None:
            self.in_step[client.transport] = client

    def take_silent(self) -> tuple["StreamClient", ...]:
        """Forget and return those who have not answered a ping, and expect an answer of the rest.

        To whom something waits, the ping may not have come yet; see `StreamClient.is_stuck`.
        """
        free = [c for c in self.clients if not c.transport.get_write_buffer_size()]
        silent = tuple(client for client in free if client.owes_answer)
        for client in silent:
            self.remove(client)
        for client in free:
            client.owes_answer = True
        return silent


class StreamClient:
    """One client; it learns from its connection how that fares."""

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
        """Its own, while it is apart."""
        self.address = address
        self.owes_answer = False
        """Whether it has not answered the last ping."""
        self._group = group
        self._clock = clock
        self._waiting = 0
        self._read_at = clock.now()
        """When it was last seen to read."""

    def clogged(self) -> None:
        """Go on alone: what was written last has to be taken first."""
        self._group.part_from(self)

    def resync(self) -> None:
        """Go on alone, with a complete frame."""
        self._group.part_from(self)
        self.cursor.begin_frames_anew()

    def answered(self) -> None:
        """Learn that the client reads."""
        self.owes_answer = False
        self._read_at = self._clock.now()

    def lost(self) -> None:
        """Write no more."""
        self._group.remove(self)

    def is_ready(self, now: Instant) -> bool:
        """Tell whether everything written before is on its way, and more can be written."""
        waiting = self.transport.get_write_buffer_size()
        if waiting == 0 or waiting < self._waiting:
            self._read_at = now
        self._waiting = waiting
        return waiting == 0 and not self.transport.is_closing()

    def is_stuck(self, now: Instant) -> bool:
        """Tell whether it has neither taken anything of what waits nor answered for too long."""
        return now - self._read_at > PATIENCE and not self.transport.is_closing()
