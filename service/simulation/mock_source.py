"""The mock signals while they run: what can be done to them, and what readings do to them."""

from collections.abc import Callable, Sequence

from domain.actor import NOBODY, Actor
from domain.health.signals import ESTOP_SIGNAL
from domain.inputs import Reading, Readings, SignalValue
from domain.outbox import Outputs
from domain.simulation.mock_signals import MOCK_SOURCE, MockSignal, MockSignals
from service.clock import Clock
from service.pacing import Pacer
from service.readings import UNNAMED, Submit


class MockHandle:
    """What can be done to mock signals that somebody else runs."""

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

    def readings(self, submit: Submit) -> "MockedReadings":
        """Return where readings from outside are handed in, so that the mock goes on with them."""
        return MockedReadings(submit, self)


class MockSource(MockHandle):
    """Mock signals on their own, as beside the nodes of a real robot; a `SignalSource`."""

    def __init__(self, mock: MockSignals, clock: Clock) -> None:
        self._pacer = Pacer(mock, clock)
        super().__init__(mock, clock, self._pacer.touch)

    async def run(self, deliver: Callable[[Readings], None]) -> None:
        """Deliver the readings of the mock until cancelled."""
        await self._pacer.run(deliver)


class MockedReadings:
    """Readings from outside where the mock runs: the mock goes on with their values.

    A `ReadingInput`. The mock stands in for a sender without a name: such readings are the mock's
    own. A named source of `estop` is kept apart from the mock's, so that each is released alone.
    """

    def __init__(self, submit: Submit, mock: MockHandle) -> None:
        self.mock = mock
        self._submit = submit

    def submit(
        self, items: Sequence[Reading], source: str | None = None, actor: Actor = NOBODY
    ) -> Outputs:
        """Hand in readings, and let the mock hold their values.

        Raises:
            PilothouseError: One of them is refused; none was taken, and the mock goes on as before.
        """
        mock = self.mock
        for readings in mock.due():
            self._submit(readings)
        # Any of them: an e-stop that came together with a signal of another kind has to be released
        # by the next reading without a name too.
        stands_in = source is None and any(mock.holds(item.signal) for item in items)
        own = mock.source if stands_in else source or UNNAMED
        outputs = self._submit(Readings(tuple(items), own, actor))
        for item in items:
            if mock.holds(item.signal) and (stands_in or item.signal != ESTOP_SIGNAL):
                mock.hold(item.signal, item.value)
        return outputs
