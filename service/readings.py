"""The way in for readings that somebody sends over HTTP, WebSocket or ROS, or in a scenario."""

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

from domain.actor import NOBODY, Actor
from domain.inputs import Input, Reading, Readings, SignalValue
from domain.outbox import Outputs

UNNAMED = "api"
"""Source of readings whose sender does not say who measured."""

Submit: TypeAlias = Callable[[Input], Outputs]
"""Hands an input to the core; raises PilothouseError if it is refused."""


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
    """Signals that are published in place of those of a robot."""

    def view(self) -> Sequence[MockSignalView]:
        """Return every signal of the mock."""
        ...

    def holds(self, signal: str) -> bool:
        """Tell whether the mock has a signal."""
        ...

    def set_publishing(self, signal: str, publishing: bool) -> None:
        """Stop publishing a signal, to see it go stale, or take it up again.

        Raises:
            UnknownSignalError: The mock has no such signal.
        """
        ...


class ReadingInput(Protocol):
    """Where readings from outside are handed in."""

    @property
    def mock(self) -> Mock | None:
        """Return the mock that readings from outside change; None: there is none."""
        ...

    def submit(
        self, items: Sequence[Reading], source: str | None = None, actor: Actor = NOBODY
    ) -> Outputs:
        """Hand in readings.

        Args:
            items: All are taken, or none is.
            source: Who measured; None: the sender does not say.
            actor: Who sent them.

        Raises:
            PilothouseError: One of them is refused; none was taken.
        """
        ...


class DirectReadings:
    """Hands readings on as they are: the `ReadingInput` of a robot without a mock."""

    mock: None = None

    def __init__(self, submit: Submit) -> None:
        self._submit = submit

    def submit(
        self, items: Sequence[Reading], source: str | None = None, actor: Actor = NOBODY
    ) -> Outputs:
        """Hand in readings; those of a sender without a name are of `api`."""
        return self._submit(Readings(tuple(items), source or UNNAMED, actor))
