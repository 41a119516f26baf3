"""How the connections to the other computers are doing, for clients and metrics."""

from collections import deque
from collections.abc import Mapping

from domain.computers import ComputerName, Connection, Incarnation
from domain.link.messages import Beat, Message
from domain.timebase import Duration, Instant, seconds

WINDOW = seconds(10.0)
"""Over which lost beats are counted."""
_MOST_BEATS = 1_000
"""Beats of a window that are remembered; a computer that sends more is not measured."""
_MOST_ECHOES = 64
"""Own beats whose echo is waited for; at ten in a second, that is longer than `lost_s`."""


class LinkStatus:
    """Measures the connections to the other computers by the messages that pass."""

    def __init__(self, beats: Mapping[ComputerName, Duration]) -> None:
        """Begin with nothing heard.

        Args:
            beats: The other computers of the robot, each with the time between two of its beats;
                messages of others are not measured.
        """
        self._measured = {name: _Measured(beat) for name, beat in beats.items()}

    def of(self, computer: ComputerName, now: Instant) -> Connection:
        """Return how the connection to a computer is doing."""
        measured = self._measured.get(computer)
        if measured is None:
            return Connection()
        return Connection(
            measured.heard_at,
            measured.round_trip,
            measured.lost_share(now),
            measured.left_out,
        )

    def note_sent(self, to: ComputerName, message: Message, now: Instant) -> None:
        """Note a message that goes out."""
        measured = self._measured.get(to)
        if measured is not None and isinstance(message, Beat):
            measured.sent.append((message.incarnation, message.seq, now))

    def note_heard(self, sender: ComputerName, message: Message, now: Instant) -> None:
        """Note a message that came in."""
        measured = self._measured.get(sender)
        if measured is not None and isinstance(message, Beat):
            measured.note_beat(message, now)

    def note_left_out(self, sender: ComputerName) -> None:
        """Note what came in and was no message, or one too many."""
        measured = self._measured.get(sender)
        if measured is not None:
            measured.left_out += 1


class _Measured:
    """What passed between this computer and another one."""

    def __init__(self, beat: Duration) -> None:
        self._beat = beat
        self.heard_at: Instant | None = None
        self.round_trip: Duration | None = None
        self.left_out = 0
        self.sent = deque[tuple[Incarnation, int, Instant]](maxlen=_MOST_ECHOES)
        self._beats = deque[Instant](maxlen=_MOST_BEATS)
        self._since: Instant = 0
        """When the first beat came."""

    def note_beat(self, beat: Beat, now: Instant) -> None:
        if self.heard_at is None:
            self._since = now
        self.heard_at = now
        self._beats.append(now)
        while self._beats[0] <= now - WINDOW:
            self._beats.popleft()
        # An older echo than the last one says nothing new: it is that of a beat that came twice.
        while self.sent and self.sent[0][1] <= beat.heard_seq:
            incarnation, seq, at = self.sent.popleft()
            if incarnation == beat.heard and seq == beat.heard_seq:
                self.round_trip = now - at

    def lost_share(self, now: Instant) -> float | None:
        if self.heard_at is None:
            return None
        begun = max(now - WINDOW, self._since)
        expected = (now - begun) // self._beat
        came = sum(at > begun for at in self._beats)
        return max(0.0, 1 - came / expected) if expected else 0.0
