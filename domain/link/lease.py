"""The lease: whether two computers hear each other, judged by the clock of one of them."""

from collections import deque
from typing import NamedTuple

from domain.link.settings import LinkSettings
from domain.timebase import Duration, Instant, to_seconds

_MAX_SENT = 1_024
"""Own beats whose sending is remembered at most; of the usual ones, those of `lost` are."""


class _Sent(NamedTuple):
    seq: int
    at: Instant


class Lease:
    """Holds while the other is heard, and echoes beats that were sent not long ago.

    An echo proves two things: that the other hears, and that what carries it was sent after the
    beat that it echoes. So whatever arrives long after it was sent, renews nothing.
    """

    def __init__(self, settings: LinkSettings) -> None:
        """Begin without a lease."""
        self._settings = settings
        self._sent = deque[_Sent]()
        self._echoed: _Sent | None = None
        """The newest own beat that was echoed."""
        self._heard_at: Instant | None = None
        self._echo_came_at: Instant = 0
        """When an echo of a newer beat came last."""
        self._last_seq = 0
        self._fence = 0
        """Echoes of beats up to this one give no lease: they were sent before it was lost."""
        self.is_held = False
        self.is_late = False
        """It holds, but nothing was heard, or nothing new echoed, for a short while."""
        self.round_trip: Duration | None = None
        """From the sending of a beat to its echo, which waits for the next beat of the other."""

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def heard_at(self) -> Instant | None:
        """Return when the other was heard last; None: never."""
        return self._heard_at

    def is_silent(self, now: Instant) -> bool:
        """Tell whether nothing was heard for so long that the other is not waited for."""
        return self._heard_at is None or now - self._heard_at >= self._settings.lost

    def was_sent_lately(self, seq: int, now: Instant) -> bool:
        """Tell whether an own beat was sent within the time of the lease."""
        at = self._sending_of(seq)
        return at is not None and now - at < self._settings.lost

    def why_lost(self, now: Instant) -> str:
        """Return why there is no lease, as a phrase that follows the other's name."""
        if self._heard_at is None:
            return "has not been heard yet"
        if now - self._heard_at >= self._settings.late:
            return f"has not been heard for {to_seconds(now - self._heard_at):.1f} s"
        return "does not hear this computer"

    def why_late(self, now: Instant) -> str:
        """Return why the lease is late, as a phrase that follows the other's name."""
        if self._heard_at is not None and now - self._heard_at >= self._settings.late:
            return f"has not been heard for {to_seconds(now - self._heard_at):.1f} s"
        return f"has not heard this computer for {to_seconds(now - self._echo_came_at):.1f} s"

    def wake_at(self) -> Instant | None:
        """Return when the lease becomes late, or ends; None: it does not hold."""
        if not self.is_held:
            return None
        return self._lost_at() if self.is_late else min(self._late_at(), self._lost_at())

    # --- what happens ----------------------------------------------------------------------------

    def note_sent(self, now: Instant) -> int:
        """Return the `seq` of a beat that is sent now."""
        self._last_seq += 1
        self._sent.append(_Sent(self._last_seq, now))
        oldest = now - self._settings.lost
        while self._sent[0].at < oldest or len(self._sent) > _MAX_SENT:
            self._sent.popleft()
        return self._last_seq

    @property
    def next_seq(self) -> int:
        """Return the `seq` of the beat that is sent next."""
        return self._last_seq + 1

    def forget(self) -> None:
        """Deal with another process: nothing was heard of it."""
        self._heard_at = self._echoed = None

    def note_heard(self, now: Instant) -> None:
        """Note that a beat of the other came."""
        self._heard_at = now

    def take_echo(self, seq: int, now: Instant) -> bool:
        """Take the echo of an own beat; return whether the lease begins with it."""
        at = self._sending_of(seq)
        if at is None or (self._echoed is not None and seq <= self._echoed.seq):
            return False
        self._echoed, self._echo_came_at = _Sent(seq, at), now
        self.round_trip = now - at
        if self.is_held or seq <= self._fence or now >= self._lost_at():
            return False
        self.is_held = True
        return True

    def judge(self, now: Instant) -> bool:
        """Note whether the lease is late; return whether it ends, since it was not renewed."""
        is_over = self.is_held and now >= self._lost_at()
        if is_over:
            self.is_held = False
            self._fence = self._last_seq
        self.is_late = self.is_held and now >= self._late_at()
        return is_over

    def _sending_of(self, seq: int) -> Instant | None:
        """Return when an own beat was sent; None: long ago, or never."""
        if not self._sent or not self._sent[0].seq <= seq <= self._last_seq:
            return None
        return self._sent[seq - self._sent[0].seq].at

    def _late_at(self) -> Instant:
        heard_at = self._heard_at if self._heard_at is not None else self._echo_came_at
        return min(heard_at, self._echo_came_at) + self._settings.late

    def _lost_at(self) -> Instant:
        if self._heard_at is None or self._echoed is None:
            return 0
        return min(self._heard_at, self._echoed.at) + self._settings.lost
