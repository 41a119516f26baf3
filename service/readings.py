"""The input for readings that clients send over HTTP, WebSocket or ROS, or that a scenario has."""

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

from domain.actor import NOBODY, Actor
from domain.inputs import Input, Reading, Readings, SignalValue
from domain.outbox import Outputs

UNNAMED = "api"
"""Source of readings whose sender does not name a source."""

Submit: TypeAlias = Callable[[Input], Outputs]
"""Passes an input to the core; raises PilothouseError if it is rejected."""


class MockSignalView(Protocol):
    """One signal of a mock, and whether the mock publishes it."""

    @property
    def signal(self) -> str:
        """Return its name."""
        ...

    @property
    def value(self) -> SignalValue:
        """Return the value that the mock holds."""
        ...

    @property
    def publishing(self) -> bool:
        """Tell whether the mock publishes it."""
        ...


class Mock(Protocol):
    """Mock signals, published in place of real ones."""

    def view(self) -> Sequence[MockSignalView]:
        """Return all mock signals."""
        ...

    def holds(self, signal: str) -> bool:
        """Tell whether the mock has a signal."""
        ...

    def set_publishing(self, signal: str, publishing: bool) -> None:
        """Stop publishing a signal, so that it becomes stale, or resume.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        ...


class ReadingInput(Protocol):
    """The input for external readings."""

    @property
    def mock(self) -> Mock | None:
        """Return the mock that external readings change; None: no mock is running."""
        ...

    def submit(
        self, items: Sequence[Reading], source: str | None = None, actor: Actor = NOBODY
    ) -> Outputs:
        """Submit readings.

        Args:
            items: Accepted all or none.
            source: Name of the sensor or device; None: the sender does not name one.
            actor: The sender.

        Raises:
            PilothouseError: One of them is rejected; none was accepted.
        """
        ...


class DirectReadings:
    """The `ReadingInput` of a robot without a mock: passes readings on unchanged."""

    mock: None = None

    def __init__(self, submit: Submit) -> None:
        self._submit = submit

    def submit(
        self, items: Sequence[Reading], source: str | None = None, actor: Actor = NOBODY
    ) -> Outputs:
        """Submit readings; the source of a sender without a name is `api`."""
        return self._submit(Readings(tuple(items), source or UNNAMED, actor))
