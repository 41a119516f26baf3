"""Stream clients: those in step are written to together, the others one by one."""

import asyncio

from api.streaming.cursor import Cursor
from api.streaming.send_buffer import unacknowledged_bytes
from domain.timebase import Instant, seconds
from service.clock import Clock

PATIENCE = seconds(4.5)
"""A client that has something to read and shows no sign of reading for this long is dropped."""

COMPLETE_EVERY = seconds(30)
"""Time between two complete frames for a client that skips none."""
_COMPLETE_BYTES_PER_S = 1_000
"""Of large robots complete frames come less often, so that an idle stream stays small."""

_KEEPS_UP_FOR = seconds(10)
"""A slow client that skipped nothing for so long keeps up: it may be us who were slow."""

_FEW, _SHARE = 5, 20
"""So many clients, or a twentieth of all, may be late at once by their own fault."""

_IN_FLIGHT_BYTES = 4_096
"""What a slow client may have to read yet when the next frame is written to it. More would only
grow old in the kernel, which takes 100 kB and more before it says that a client does not read."""


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
        if client.is_slow and not client.has_caught_up():
            return
        has_all = client.cursor.position == self.cursor.position
        has_taken = not client.transport.get_write_buffer_size()
        # It may have disconnected during the write.
        if has_all and has_taken and self.apart.pop(client.transport, None) is not None:
            self.in_step[client.transport] = client

    def ask_all(self, *, judged: bool) -> None:
        """Let clients owe an answer to the ping that is sent next.

        Slow ones have pings of their own. Those with waiting data may not receive this one in time;
        see `StreamClient.is_stuck`.

        Args:
            judged: Whether those who still owe one are slow.
        """
        for client in self._asked():
            if judged and client.owes_answer:
                self._slow_down(client)
            client.owes_answer = True

    def part_from_late(self) -> None:
        """Let those who still owe an answer continue alone, as slow ones, if they are few.

        If they are many, this machine is busy, or the network: they have until the next ping then,
        and go on to cost little meanwhile.
        """
        late = [client for client in self._asked() if client.owes_answer]
        slow = sum(client.is_slow for client in self.apart.values())
        if slow + len(late) <= max(_FEW, len(self.clients) // _SHARE):
            for client in late:
                self._slow_down(client)

    def _asked(self) -> list["StreamClient"]:
        """Return those that the pings of all reach."""
        return [c for c in self.clients if not (c.is_slow or c.transport.get_write_buffer_size())]

    def _slow_down(self, client: "StreamClient") -> None:
        client.begin_to_be_slow()
        self.part_from(client)

    def due_for_complete(self, now: Instant) -> list["StreamClient"]:
        """Return the clients whose last complete frame is too long ago."""
        return [client for client in self.clients if now >= client.complete_at]


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
        self.is_slow = False
        """Whether it reads less than is published: it then gets a frame when it has read most."""
        self.complete_at = clock.now() + COMPLETE_EVERY
        """When it gets a complete frame, unless it gets one before."""
        self._unacknowledged = 0
        self._group = group
        self._clock = clock
        self._waiting = 0
        self._read_at = clock.now()
        """Time of its last sign of reading."""
        self._skipped_at = clock.now()
        """When it was last too late for a frame, while it was slow."""

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
        if self.is_slow:
            return self._has_read_most(waiting, now) and not self.transport.is_closing()
        if waiting == 0 or waiting < self._waiting:
            self._read_at = now
        self._waiting = waiting
        return waiting == 0 and not self.transport.is_closing()

    def begin_to_be_slow(self) -> None:
        """Note that it does not keep up, or is dead; it has `PATIENCE` from its last sign on."""
        self._unacknowledged = unacknowledged_bytes(self.transport)
        self.is_slow = True
        self._skipped_at = self._clock.now()

    def note_asked(self, skipped: int) -> None:
        """Note that a ping of its own was written to a slow client: its answer tells that it reads.

        Args:
            skipped: How many frames it had skipped before.
        """
        self.owes_answer = True
        if skipped:
            self._skipped_at = self._clock.now()

    def has_caught_up(self) -> bool:
        """Tell whether a slow client reads as much as is published by now; it is not slow then."""
        self.is_slow = self._clock.now() - self._skipped_at < _KEEPS_UP_FOR
        return not self.is_slow

    def note_complete(self, size: int) -> None:
        """Note that a complete frame was written; the next one is due after some time.

        Args:
            size: Of what was written, bytes.
        """
        pause = max(COMPLETE_EVERY, seconds(size / _COMPLETE_BYTES_PER_S))
        self.complete_at = self._clock.now() + pause

    def _has_read_most(self, waiting: int, now: Instant) -> bool:
        """Tell whether little is left to read; note it if that became less."""
        left = waiting + unacknowledged_bytes(self.transport)
        if left < self._unacknowledged:
            self._read_at = now
        self._unacknowledged = left
        # What its own computer has taken it may not have read; its answer tells.
        is_read = left <= _IN_FLIGHT_BYTES and not (self.owes_answer and left == 0)
        return waiting == 0 and is_read

    def is_stuck(self, now: Instant) -> bool:
        """Tell whether it has neither read waiting data nor answered a ping for too long."""
        return now - self._read_at > PATIENCE and not self.transport.is_closing()
