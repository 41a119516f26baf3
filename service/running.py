"""Tasks that should run for as long as the service does."""

import asyncio
from collections.abc import Coroutine, Mapping


class TaskFailedError(Exception):
    """A task that should run for as long as the service does has ended."""

    def __init__(self, name: str) -> None:
        super().__init__(f"the task {name!r} has ended")
        self.name = name


async def run_forever(work: Mapping[str, Coroutine[object, object, None]]) -> None:
    """Run tasks until cancelled; the first that ends, ends them all.

    Args:
        work: What each does, by its name.

    Raises:
        ExceptionGroup: Of a `TaskFailedError` that names the task and has what it raised as its
            cause.
    """
    async with asyncio.TaskGroup() as tasks:
        for name, coroutine in work.items():
            tasks.create_task(_forever(name, coroutine), name=name)


async def _forever(name: str, work: Coroutine[object, object, None]) -> None:
    """Await what should never end, and name it when it does."""
    try:
        await work
    except Exception as error:
        raise TaskFailedError(name) from error
    raise TaskFailedError(name)
