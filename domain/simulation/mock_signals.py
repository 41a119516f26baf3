"""Signals of a robot that is not there: values that somebody set, published over and over."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from domain.errors import UnknownSignalError
from domain.inputs import Reading, Readings, SignalValue
from domain.timebase import Duration, Instant, seconds

MOCK_SOURCE = "mock"

PERIOD: Duration = seconds(0.1)

GOOD_VALUES: Mapping[str, SignalValue] = MappingProxyType(
    {
        "battery_level": 1.0,
        "estop": False,
        "gps_accuracy": 100.0,
        "signal_strength": "CONNECTED",
        "temperature": 30.0,
    }
)
"""What is held at the start: no error. Source: smart_polaris, the mock node's own start."""


@dataclass(frozen=True, slots=True)
class MockSignal:
    """One signal of the mock, and what is done with it."""

    signal: str
    value: SignalValue
    publishing: bool


class MockSignals:
    """Publishes the five signals at 10 Hz as one message, the first at `start` itself.

    Deterministic, and advanced like the core. Publishing keeps to `start + n * PERIOD`; when time
    was not told for longer, what was missed is not made up for. What `now` is given must never
    fall. Values are taken as they are: whoever holds one has checked it as any reading.
    """

    def __init__(self, start: Instant) -> None:
        self._values = dict(GOOD_VALUES)
        self._stopped: set[str] = set()
        self._messages: list[Readings] = []
        self._messages_at = start
        self._next = start

    def advance(self, now: Instant) -> tuple[Readings, ...]:
        """Return everything due up to `now`."""
        self._catch_up(now)
        messages, self._messages = tuple(self._messages), []
        return messages

    def wake_at(self) -> Instant:
        """Return when `advance` next has something to say."""
        return self._messages_at if self._messages else self._next

    def holds(self, signal: str) -> bool:
        """Tell whether the mock has this signal."""
        return signal in self._values

    def hold(self, signal: str, value: SignalValue, now: Instant) -> None:
        """Hold `value` from now on, and publish it at once unless the signal's publishing is off.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        self._catch_up(now)
        self._require(signal)
        self._values[signal] = value
        if signal not in self._stopped:
            self._publish((signal,), now)

    def set_publishing(self, signal: str, publishing: bool, now: Instant) -> None:
        """Stop publishing a signal, to see it go stale, or take it up again at once.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        self._catch_up(now)
        self._require(signal)
        if not publishing:
            self._stopped.add(signal)
        elif signal in self._stopped:
            self._stopped.remove(signal)
            self._publish((signal,), now)

    def view(self) -> tuple[MockSignal, ...]:
        """Return every signal of the mock, in the order of its table."""
        return tuple(
            MockSignal(signal, value, signal not in self._stopped)
            for signal, value in self._values.items()
        )

    def _require(self, signal: str) -> None:
        if not self.holds(signal):
            raise UnknownSignalError("mock signal", signal, tuple(self._values))

    def _catch_up(self, now: Instant) -> None:
        if now < self._next:
            return
        publishing = tuple(signal for signal in self._values if signal not in self._stopped)
        # A node that publishes late does so once, and keeps to its grid from then on.
        last_due = now - (now - self._next) % PERIOD
        if publishing:
            self._publish(publishing, last_due)
        self._next = last_due + PERIOD

    def _publish(self, signals: tuple[str, ...], at: Instant) -> None:
        readings = tuple(Reading(signal, self._values[signal]) for signal in signals)
        self._messages.append(Readings(readings, source=MOCK_SOURCE))
        self._messages_at = at
