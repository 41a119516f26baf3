"""The port through which a run stimulates a robot and watches it."""

from dataclasses import dataclass
from typing import Protocol

from api.profiling.triggers import Settings


class LostServiceError(Exception):
    """The service ended, closed the connection or did not answer: nothing more can be measured."""


@dataclass(frozen=True, slots=True)
class Seen:
    """What a client knows after a frame."""

    at_s: float
    """When the frame came."""
    state: str
    """System state: `IDLE`, `RUNNING` or `ERROR`."""
    errors: tuple[str, ...]
    task_status: str
    """Status of the planner, such as `PAUSED_TASK`."""
    command_mps: float
    """Speed of the latest drive command, m/s."""


class Robot(Protocol):
    """A robot that is driven, stopped and watched. Times are in s, on its own clock."""

    @property
    def settings(self) -> Settings:
        """Return the settings of its signals."""
        ...

    def now(self) -> float:
        """Return the present time."""
        ...

    async def drive(self, length_m: float) -> None:
        """Submit a task that leads straight ahead, which replaces the current one.

        Raises:
            LostServiceError: The service does not answer.
        """
        ...

    async def send(self, signal: str, value: float | bool | str) -> float:
        """Send a reading, and return when.

        Raises:
            LostServiceError: The connection is closed.
        """
        ...

    async def echo(self) -> float:
        """Return how long a message and its answer take when nothing is decided.

        Raises:
            LostServiceError: There is no answer.
        """
        ...

    async def seen(self, until: float) -> Seen | None:
        """Return what the next frame tells; None: there was none until then.

        Raises:
            LostServiceError: The connection is closed.
        """
        ...
