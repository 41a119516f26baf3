"""Mock signals: held values that are published periodically."""

from collections.abc import Iterable, Mapping
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
"""Initial values, without errors. Source: smart_polaris, initial values of its mock node."""


@dataclass(frozen=True, slots=True)
class MockSignal:
    """One signal of the mock."""

    signal: str
    value: SignalValue
    publishing: bool


class MockSignals:
    """Publishes the five signals at 10 Hz as one message, the first one at `start`.

    Deterministic, and advanced like the core. Messages are published at `start + n * PERIOD`;
    missed ones are not made up for. `now` must never decrease from call to call. Values are not
    checked here: the caller checks them like any reading.
    """

    def __init__(self, start: Instant) -> None:
        self._values = dict(GOOD_VALUES)
        self._stopped: set[str] = set()
        self._messages: list[Readings] = []
        self._messages_at = start
        self._next = start

    def advance(self, now: Instant) -> tuple[Readings, ...]:
        """Return all messages due up to `now`."""
        self._catch_up(now)
        messages, self._messages = tuple(self._messages), []
        return messages

    def wake_at(self) -> Instant:
        """Return when the next message is due."""
        return self._messages_at if self._messages else self._next

    def holds(self, signal: str) -> bool:
        """Tell whether the mock has this signal."""
        return signal in self._values

    def leave_out(self, signals: Iterable[str]) -> None:
        """Publish none of these signals, also not at the start; the mock need not have them."""
        self._stopped.update(signal for signal in signals if self.holds(signal))

    def hold(self, signal: str, value: SignalValue, now: Instant) -> None:
        """Hold `value` from now on, and publish it at once unless publishing is stopped.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        self._catch_up(now)
        self._require(signal)
        self._values[signal] = value
        if signal not in self._stopped:
            self._publish((signal,), now)

    def set_publishing(self, signal: str, publishing: bool, now: Instant) -> None:
        """Stop publishing a signal, so that it becomes stale, or resume at once.

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
        # A node that is late publishes once, and keeps its period from then on.
        last_due = now - (now - self._next) % PERIOD
        if publishing:
            self._publish(publishing, last_due)
        self._next = last_due + PERIOD

    def _publish(self, signals: tuple[str, ...], at: Instant) -> None:
        readings = tuple(Reading(signal, self._values[signal]) for signal in signals)
        self._messages.append(Readings(readings, source=MOCK_SOURCE))
        self._messages_at = at
