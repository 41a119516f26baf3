"""The connection of one client of rosbridge: what is written to it, and whether it still reads."""

from collections.abc import Iterable

from api.streaming.websocket_frames import PING, Connection, text_frame
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock

PATIENCE = seconds(4.5)
"""A client to whom something waits, and that takes nothing of it for so long, does not read."""
PING_EVERY = seconds(1.0)
_ANSWER_WITHIN = PATIENCE - PING_EVERY
"""Also one to whom nothing waits is noticed so long after it stopped to read."""


class Wire:
    """Learns from the connection how it fares."""

    def __init__(self, connection: Connection, clock: Clock) -> None:
        """Begin with a client that was just let in.

        Args:
            connection: It is accepted.
            clock: Tells how long a client has been silent.
        """
        self._transport = connection.transport
        self._clock = clock
        self._ping_at = clock.now() + PING_EVERY
        self._owes_by: Instant | None = None
        """Until when it has to show that it reads; None: it did."""
        self._left = 0

    def clogged(self) -> None:
        """Learn that something waits; `is_free` looks at that."""

    def answered(self) -> None:
        """Learn that the client reads."""
        self._owes_by = None

    def heard(self) -> None:
        """Learn that the client said something, behind which its answer to a ping may wait.

        To one that takes nothing that does not help: it may talk and not read.
        """
        if not self._left:
            self._owes_by = None

    def lost(self) -> None:
        """Learn that the connection is gone; then `is_free` is false."""

    def is_free(self) -> bool:
        """Tell whether everything written before is on its way, and more can be written."""
        left = self._transport.get_write_buffer_size()
        if left < self._left:
            self._owes_by = None
        if left:
            self._expect_reading(PATIENCE)
        self._left = left
        return not left and not self._transport.is_closing()

    def is_silent(self) -> bool:
        """Tell whether the client does not read any more."""
        return self._owes_by is not None and self._clock.now() > self._owes_by

    def write(self, texts: Iterable[str]) -> None:
        """Send texts."""
        self._transport.write(b"".join(map(text_frame, texts)))

    def ping(self) -> None:
        """Ask for a sign of life, if that is due; only while it `is_free`."""
        if self._clock.now() >= self._ping_at:
            self._ping_at = self._clock.now() + PING_EVERY
            self._expect_reading(_ANSWER_WITHIN)
            self._transport.write(PING)

    def cut_off(self) -> None:
        """End the connection at once."""
        self._transport.abort()

    def _expect_reading(self, within: Duration) -> None:
        if self._owes_by is None:
            self._owes_by = self._clock.now() + within
