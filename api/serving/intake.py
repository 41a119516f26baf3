"""What arrives on one connection, and when its protocol gets it."""

import asyncio
import logging
from collections.abc import Callable
from enum import Enum, auto
from typing import Protocol, cast

from api.serving.paced_transport import PacedTransport
from api.serving.pieces import LOSS_COST, READ_COST, Piece
from api.serving.turns import RECENT_TURNS, Turns, Urgency

log = logging.getLogger(__name__)

READ_BYTES = 16_384
"""Read from the network at once."""


class Dispensable(Enum):
    """Whether a connection may be closed for a new one."""

    AT_ONCE = auto()
    """It has no complete head, or no token yet."""
    IF_NEEDED = auto()
    """Its body is incomplete."""
    NOT = auto()


class Inner(Protocol):
    """The protocol of a connection: HTTP, or WebSocket after the handshake."""

    @property
    def in_message(self) -> bool:
        """Tell whether a request has begun whose body is incomplete."""
        ...

    @property
    def dispensable(self) -> Dispensable:
        """Return whether it may be closed for a new one."""
        ...

    def overdue(self, now: float) -> str | None:
        """Return for what the client took too long, by the clock of the loop; None: for nothing."""
        ...

    def connection_made(self, transport: asyncio.Transport) -> None:
        """Take over a connection."""
        ...

    def connection_lost(self, exc: Exception | None) -> None:
        """Handle the end."""
        ...

    def data_received(self, data: bytes) -> None:
        """Handle a piece."""
        ...

    def next_piece(self, waiting: bytearray) -> Piece:
        """Return the piece at the beginning of what waits; `INCOMPLETE`: more bytes are needed."""
        ...

    def eof_received(self) -> None:
        """Handle that the client sends nothing more."""
        ...

    def pause_writing(self) -> None:
        """Handle that the client reads too slowly."""
        ...

    def resume_writing(self) -> None:
        """Handle that the client reads again."""
        ...


class Watcher(Protocol):
    """Knows all connections."""

    def opened(self, intake: "Intake") -> None:
        """Note a new connection."""
        ...

    def closed(self, intake: "Intake") -> None:
        """Note that a connection has ended."""
        ...


class Intake(asyncio.BufferedProtocol):
    """Hands what arrives to a protocol, in pieces and when it is its turn.

    While complete pieces wait nothing more is read, so that the kernel makes the client wait.
    """

    urgency = Urgency.REST
    served_in = -RECENT_TURNS
    # Shared: it is emptied before the loop reads from another connection.
    _buffer = memoryview(bytearray(READ_BYTES))

    def __init__(
        self,
        inner: Inner,
        turns: Turns,
        watcher: Watcher,
        urgency_of: Callable[[bytes | bytearray], Urgency],
    ) -> None:
        """Prepare.

        Args:
            inner: Takes what arrives.
            turns: Shared by all connections.
            watcher: Is told of beginning and end.
            urgency_of: Tells how soon what begins with these bytes is served.
        """
        self.inner = inner
        self._turns = turns
        self._watcher = watcher
        self._urgency_of = urgency_of
        self._waiting = bytearray()
        self._of_head = Urgency.REST
        """Of the request whose body is awaited."""
        self._is_queued = False
        self._is_held = False
        """Whether the protocol wants no data."""
        self._is_reading = True
        self._lost: tuple[Exception | None] | None = None
        """Why the connection ended, until the protocol is told."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take over a connection."""
        self.raw = cast("asyncio.Transport", transport)
        self.transport = PacedTransport(self.raw, self._hold, self._go_on, self._succeed)
        self._watcher.opened(self)
        self.inner.connection_made(self.transport)

    def connection_lost(self, exc: Exception | None) -> None:
        """Tell that nothing more will arrive; in turn, since many may end at once."""
        self._waiting.clear()
        self._watcher.closed(self)
        self._lost = (exc,)
        if self._turns.has_room:
            self._turns.spend(self._end())
        elif not self._is_queued:
            self._is_queued = True
            self.urgency = Urgency.REST
            self._turns.wait(self)

    def get_buffer(self, sizehint: int) -> memoryview:
        """Return where the next bytes go."""
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        """Take what arrived: at once if nobody waits and the turn has room, else in turn."""
        self._waiting += self._buffer[:nbytes]
        self._turns.spend(READ_COST)
        if self._is_queued or self._is_held:
            self._read(False)
            return
        while self._turns.has_room and not self._is_held:
            cost = self._hand_on()
            if not cost:
                return
            self._turns.spend(cost)
        self._queue()

    def eof_received(self) -> bool | None:
        """Tell that the client sends nothing more."""
        self.inner.eof_received()
        return None

    def pause_writing(self) -> None:
        """Tell that the client reads too slowly."""
        self.inner.pause_writing()

    def resume_writing(self) -> None:
        """Tell that the client reads again."""
        self.inner.resume_writing()

    def serve(self) -> int:
        """Handle the next piece, or the end."""
        if self._lost is not None:
            return self._end()
        cost = 0 if self._is_held else self._hand_on()
        if cost and self.inner.in_message and not self._is_held:
            # A small body is handled with its head, and does not wait for a turn of its own.
            cost += self._hand_on()
        if not cost:
            self._is_queued = False
            self._read(not self._is_held)
        return cost

    def _end(self) -> int:
        """Tell the protocol that the connection has ended; return what that costs."""
        if self._lost is None:
            return 0
        (reason,), self._lost = self._lost, None
        try:
            self.inner.connection_lost(reason)
        except Exception:
            log.exception("the end of a connection")
        # They refer to each other: parted here, they need no garbage collection.
        self.transport.part()
        del self.inner, self.transport
        return LOSS_COST

    def _hand_on(self) -> int:
        """Hand the next piece on; return its cost, 0: there is none."""
        if not self._waiting or self.raw.is_closing():
            self._waiting.clear()
            return 0
        try:
            cost = self._hand_on_piece()
        except Exception:
            # The other connections go on.
            log.exception("a connection is closed")
            self.raw.abort()
            return READ_COST
        if cost and not self.inner.in_message:
            # Not before: the body of a stop is as urgent as its head was.
            self.served_in = self._turns.number
        return cost

    def _hand_on_piece(self) -> int:
        piece = self.inner.next_piece(self._waiting)
        if not piece.length:
            return 0
        data = bytes(memoryview(self._waiting)[: piece.length])
        del self._waiting[: piece.length]
        if not self.inner.in_message:
            self._of_head = self._urgency_of(data)
        self.inner.data_received(data)
        self._judge()
        return piece.cost

    def _judge(self) -> None:
        """Note how urgent what waits is: a body as much as its head."""
        in_message = self.inner.in_message
        self.urgency = self._of_head if in_message else self._urgency_of(self._waiting)

    def _queue(self) -> None:
        if self._waiting and not self._is_queued and not self._is_held:
            self._read(False)
            self._is_queued = True
            self._judge()
            self._turns.wait(self)

    def _hold(self) -> None:
        self._is_held = True
        self._read(False)

    def _go_on(self) -> None:
        self._is_held = False
        if self._waiting:
            self._queue()
        else:
            self._read(True)

    def _read(self, wanted: bool) -> None:
        if wanted != self._is_reading and not self.raw.is_closing():
            self._is_reading = wanted
            if wanted:
                self.raw.resume_reading()
            else:
                self.raw.pause_reading()

    def _succeed(self, protocol: asyncio.BaseProtocol) -> None:
        self.inner = cast("Inner", protocol)
