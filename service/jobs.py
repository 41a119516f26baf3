"""Work that takes longer than the event loop may be kept: who takes it, whoever does it."""

from collections.abc import Callable
from typing import Protocol, TypeVar, TypeVarTuple

Given = TypeVarTuple("Given")
Result = TypeVar("Result")


class Jobs(Protocol):
    """Takes jobs, one after the other."""

    async def close(self) -> None:
        """End for good; jobs that are not done fail."""
        ...

    async def call(self, function: Callable[[*Given], Result], *arguments: *Given) -> Result:
        """Return what a function returns.

        Args:
            function: One that a module names, since it may be sent by its name.
            arguments: What it is called with.

        Raises:
            PilothouseError: Raised by the function, or the job cannot be done.
        """
        ...


class InlineJobs:
    """Does jobs at once, for who is in a worker process already."""

    async def close(self) -> None:
        """Do nothing: there is no process."""

    async def call(self, function: Callable[[*Given], Result], *arguments: *Given) -> Result:
        """Return what a function returns.

        Raises:
            PilothouseError: Raised by the function.
        """
        return function(*arguments)
