"""What has come in from other computers and waits for the event loop.

A computer that sends too much loses its own messages and costs the others nothing: what waits is
bounded for each sender, in number, in bytes and in rate. Beats have an allowance of their own, so
that a flood of messages hides no sign of life and no stop of the same sender either.
"""

import asyncio
import threading
from collections import deque
from collections.abc import Callable, Iterable

from domain.computers import ComputerName
from service.link.port import (
    MAX_BEATS_PER_S,
    MAX_BYTES_PER_S,
    MAX_MESSAGE_BYTES,
    MAX_MESSAGES_PER_S,
    DeliverMessage,
    LinkCounts,
)

_BEATS_WAITING = 16
"""Of one sender; of more, the oldest are dropped, since each beat tells everything anew."""
_AT_ONCE = 8
"""Most messages in one pass of the event loop; one takes a tenth of a millisecond and more."""


class Intake:
    """Passes messages from any thread to the event loop; in turns, if many senders have some.

    Args:
        senders: Who may send; from anybody else nothing is taken in.
        monotonic_s: Returns monotonic time in seconds, for the rates.
    """

    def __init__(self, senders: Iterable[ComputerName], monotonic_s: Callable[[], float]) -> None:
        self._now = monotonic_s
        self._lock = threading.Lock()
        self._senders = {name: _Sender(monotonic_s()) for name in senders}
        self._turns: deque[ComputerName] = deque()
        """Senders of which something waits, the next one first."""
        self._unknown = 0
        self._loop: asyncio.AbstractEventLoop | None = None
        self._deliver: DeliverMessage | None = None

    def open(self, deliver: DeliverMessage) -> None:
        """Begin to deliver on the event loop that is running now."""
        self._loop = asyncio.get_running_loop()
        self._deliver = deliver

    def close(self) -> None:
        """Deliver nothing any more, and forget what waits."""
        with self._lock:
            self._loop = self._deliver = None
            self._turns.clear()
            for sender in self._senders.values():
                sender.forget()

    def take_in(self, name: ComputerName, message: bytes, *, may_be_lost: bool) -> None:
        """Let a message wait for the event loop; may be called on any thread."""
        with self._lock:
            loop = self._loop
            if loop is None:
                return
            sender = self._senders.get(name)
            if sender is None:
                self._unknown += 1
                return
            if not sender.accept(message, self._now(), may_be_lost=may_be_lost):
                return
            wakes = not self._turns
            if name not in self._turns:
                self._turns.append(name)
        if wakes:
            try:
                loop.call_soon_threadsafe(self._hand_out)
            except RuntimeError:
                # The loop is closed: nothing is left that could take the message.
                return

    def counts(self) -> LinkCounts:
        """Return what was dropped so far."""
        with self._lock:
            dropped = {name: sender.dropped for name, sender in self._senders.items()}
            return LinkCounts(dropped, self._unknown)

    def _hand_out(self) -> None:
        """Deliver some messages, and the others in the next passes of the loop."""
        loop = asyncio.get_running_loop()
        with self._lock:
            due = [self._next() for _ in range(_AT_ONCE) if self._turns]
            has_more = bool(self._turns)
        for name, message in due:
            # One call each, so that an exception over one message does not lose the others.
            loop.call_soon(self._call, name, message)
        if has_more:
            loop.call_soon(self._hand_out)

    def _next(self) -> tuple[ComputerName, bytes]:
        name = self._turns.popleft()
        sender = self._senders[name]
        message = sender.pop()
        if sender.has_some:
            self._turns.append(name)
        return name, message

    def _call(self, name: ComputerName, message: bytes) -> None:
        if self._deliver is not None:
            self._deliver(name, message)


class _Sender:
    """What waits of one sender."""

    def __init__(self, now: float) -> None:
        self.dropped = 0
        self._beats: deque[bytes] = deque()
        self._messages: deque[bytes] = deque()
        self._waiting_bytes = 0
        self._beat_rate = _Rate(MAX_BEATS_PER_S, now)
        self._message_rate = _Rate(MAX_MESSAGES_PER_S, now)
        self._byte_rate = _Rate(MAX_BYTES_PER_S, now)

    @property
    def has_some(self) -> bool:
        return bool(self._beats or self._messages)

    def accept(self, message: bytes, now: float, *, may_be_lost: bool) -> bool:
        """Tell whether the message waits now; otherwise it is dropped."""
        takes = self._accept_beat if may_be_lost else self._accept_message
        accepted = len(message) <= MAX_MESSAGE_BYTES and takes(message, now)
        self.dropped += not accepted
        return accepted

    def pop(self) -> bytes:
        """Return the next message, beats first."""
        if self._beats:
            return self._beats.popleft()
        message = self._messages.popleft()
        self._waiting_bytes -= len(message)
        return message

    def forget(self) -> None:
        self._beats.clear()
        self._messages.clear()
        self._waiting_bytes = 0

    def _accept_beat(self, message: bytes, now: float) -> bool:
        if not self._beat_rate.allows(1, now):
            return False
        if len(self._beats) == _BEATS_WAITING:
            self._beats.popleft()
            self.dropped += 1
        self._beats.append(message)
        return True

    def _accept_message(self, message: bytes, now: float) -> bool:
        # A second of messages may wait; their number is bounded by the rate, as are their bytes.
        has_room = (
            len(self._messages) < MAX_MESSAGES_PER_S
            and self._waiting_bytes + len(message) <= MAX_BYTES_PER_S
        )
        if not (
            has_room
            and self._byte_rate.allows(len(message), now)
            and self._message_rate.allows(1, now)
        ):
            return False
        self._messages.append(message)
        self._waiting_bytes += len(message)
        return True


class _Rate:
    """A token bucket that holds one second."""

    def __init__(self, per_s: float, now: float) -> None:
        self._per_s = per_s
        self._tokens = per_s
        self._at = now

    def allows(self, count: float, now: float) -> bool:
        """Take `count` tokens if there are so many."""
        self._tokens = min(self._per_s, self._tokens + (now - self._at) * self._per_s)
        self._at = now
        if self._tokens < count:
            return False
        self._tokens -= count
        return True
