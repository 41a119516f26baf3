"""What can be done to the mock signals while they run."""

from collections.abc import Callable

from domain.inputs import Readings, SignalValue
from domain.simulation.mock_signals import MOCK_SOURCE, MockSignal, MockSignals
from service.clock import Clock


class MockSource:
    """The mock signals of a simulated robot that somebody else runs."""

    source = MOCK_SOURCE
    """The source that its readings name."""

    def __init__(self, mock: MockSignals, clock: Clock, touch: Callable[[], None]) -> None:
        """Prepare.

        Args:
            mock: The signals.
            clock: The present.
            touch: Called when there is something to publish earlier than was said before.
        """
        self._mock = mock
        self._clock = clock
        self._touch = touch

    def due(self) -> tuple[Readings, ...]:
        """Return what is due by now and not delivered yet; the caller delivers it.

        For one who is about to hand in a newer value, which must not be followed by an older one.
        """
        return self._mock.advance(self._clock.now())

    def holds(self, signal: str) -> bool:
        """Tell whether the mock has this signal; it has no declared ones beyond the five."""
        return self._mock.holds(signal)

    def hold(self, signal: str, value: SignalValue) -> None:
        """Hold a value from now on; it must be one that the signal can have.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        self._mock.hold(signal, value, self._clock.now())
        self._touch()

    def set_publishing(self, signal: str, publishing: bool) -> None:
        """Stop publishing a signal, to see it go stale, or take it up again.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        self._mock.set_publishing(signal, publishing, self._clock.now())
        self._touch()

    def view(self) -> tuple[MockSignal, ...]:
        """Return every signal of the mock."""
        return self._mock.view()
