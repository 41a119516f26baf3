"""The connection of one client of rosbridge: what is written to it, and whether it still reads."""

from collections.abc import Iterable

from api.streaming.websocket_frames import PING, Connection, text_frame
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock

PATIENCE = seconds(4.5)
"""A client that reads nothing of waiting data for this long counts as not reading."""
PING_EVERY = seconds(1.0)
_ANSWER_WITHIN = PATIENCE - PING_EVERY
"""Timeout of a ping: a client without waiting data is also detected within `PATIENCE`."""


class Wire:
    """Writes to the connection, and tracks whether the client still reads."""

    def __init__(self, connection: Connection, clock: Clock) -> None:
        """Start with a client that was just accepted.

        Args:
            connection: An accepted connection.
            clock: Of the service.
        """
        self._transport = connection.transport
        self._clock = clock
        self._ping_at = clock.now() + PING_EVERY
        self._owes_by: Instant | None = None
        """Deadline for a sign that the client reads; None: none is expected."""
        self._left = 0

    def clogged(self) -> None:
        """Ignore that data waits; `is_free` checks this itself."""

    def answered(self) -> None:
        """Note that the client answered a ping, and so reads."""
        self._owes_by = None

    def heard(self) -> None:
        """Note that the client sent a message, behind which its answer to a ping may wait.

        This does not count while data waits: the client may send without reading.
        """
        if not self._left:
            self._owes_by = None

    def lost(self) -> None:
        """Ignore that the connection is closed; `is_free` is false then."""

    def is_free(self) -> bool:
        """Tell whether all earlier data was sent, and more can be written."""
        left = self._transport.get_write_buffer_size()
        if left < self._left:
            self._owes_by = None
        if left:
            self._expect_reading(PATIENCE)
        self._left = left
        return not left and not self._transport.is_closing()

    def is_silent(self) -> bool:
        """Tell whether the client has stopped reading."""
        return self._owes_by is not None and self._clock.now() > self._owes_by

    def write(self, texts: Iterable[str]) -> None:
        """Send texts."""
        self._transport.write(b"".join(map(text_frame, texts)))

    def ping(self) -> None:
        """Send a ping if one is due; only while `is_free`."""
        if self._clock.now() >= self._ping_at:
            self._ping_at = self._clock.now() + PING_EVERY
            self._expect_reading(_ANSWER_WITHIN)
            self._transport.write(PING)

    def cut_off(self) -> None:
        """Abort the connection."""
        self._transport.abort()

    def _expect_reading(self, within: Duration) -> None:
        if self._owes_by is None:
            self._owes_by = self._clock.now() + within
