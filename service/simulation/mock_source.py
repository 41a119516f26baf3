"""The running mock signals: their controls, and how external readings change them."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from domain.actor import NOBODY, Actor
from domain.health.signals import ESTOP_SIGNAL, SignalSpec, default_signals
from domain.inputs import Reading, Readings, SignalValue
from domain.outbox import Outputs
from domain.simulation.mock_signals import MOCK_SOURCE, MockSignal, MockSignals
from service.clock import Clock
from service.pacing import Pacer
from service.readings import UNNAMED, Submit

_SPECS: Mapping[str, SignalSpec] = MappingProxyType(
    {settings.spec.name: settings.spec for settings in default_signals()}
)
"""Of the standard signals; a robot file does not change which values they have."""


class MockHandle:
    """Controls mock signals that another object runs."""

    source = MOCK_SOURCE
    """The source of its readings."""

    def __init__(self, mock: MockSignals, clock: Clock, touch: Callable[[], None]) -> None:
        """Prepare.

        Args:
            mock: The signals.
            clock: Of the service.
            touch: Called when a reading is due earlier than before.
        """
        self._mock = mock
        self._clock = clock
        self._touch = touch

    def due(self) -> tuple[Readings, ...]:
        """Return the readings that are due and not delivered yet; the caller delivers them.

        Needed before a newer value is submitted, so that no older one follows it.
        """
        return self._mock.advance(self._clock.now())

    def holds(self, signal: str) -> bool:
        """Tell whether the mock has this signal; it has only the five standard ones."""
        return self._mock.holds(signal)

    def hold(self, signal: str, value: SignalValue) -> None:
        """Publish this value from now on; it must be valid for the signal.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        self._mock.hold(signal, value, self._clock.now())
        self._touch()

    def set_publishing(self, signal: str, publishing: bool) -> None:
        """Stop publishing a signal, so that it becomes stale, or resume.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        self._mock.set_publishing(signal, publishing, self._clock.now())
        self._touch()

    def view(self) -> tuple[MockSignal, ...]:
        """Return all mock signals."""
        return self._mock.view()

    def readings(self, submit: Submit) -> "MockedReadings":
        """Return an input for external readings whose values the mock then continues to publish."""
        return MockedReadings(submit, self)


class MockSource(MockHandle):
    """A `SignalSource` with mock signals, for use with the nodes of a real robot."""

    def __init__(self, mock: MockSignals, clock: Clock) -> None:
        self._pacer = Pacer(mock, clock)
        super().__init__(mock, clock, self._pacer.touch)

    async def run(self, deliver: Callable[[Readings], None]) -> None:
        """Deliver the readings of the mock until cancelled."""
        await self._pacer.run(deliver)


class MockedReadings:
    """The `ReadingInput` while the mock runs: the mock continues with the values of readings.

    Readings without a source count as those of the mock. A named source of `estop` is separate from
    the mock, so that each must be released by itself.
    """

    def __init__(self, submit: Submit, mock: MockHandle) -> None:
        self.mock = mock
        self._submit = submit

    def submit(
        self, items: Sequence[Reading], source: str | None = None, actor: Actor = NOBODY
    ) -> Outputs:
        """Submit readings, and let the mock continue with their values.

        Args:
            items: Accepted all or none.
            source: Name of the sensor or device; None: the sender does not name one.
            actor: The sender.

        Raises:
            PilothouseError: One is rejected; none was accepted, and the mock did not change.
        """
        mock = self.mock
        for readings in mock.due():
            self._submit(readings)
        # Any of them: an e-stop that came together with another signal must also be released by the
        # next reading without a source.
        stands_in = source is None and any(mock.holds(item.signal) for item in items)
        own = mock.source if stands_in else source or UNNAMED
        outputs = self._submit(Readings(tuple(items), own, actor))
        for item in items:
            if mock.holds(item.signal) and (stands_in or item.signal != ESTOP_SIGNAL):
                # As the signal holds it: a posted 2 is LOW_SIGNAL, and 1 of `estop` is true.
                mock.hold(item.signal, _SPECS[item.signal].checked(item.value))
        return outputs
