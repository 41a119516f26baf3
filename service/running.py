"""Background tasks that must run as long as the service does."""

import asyncio
from collections.abc import Coroutine, Mapping


class TaskFailedError(Exception):
    """A background task ended although it must run as long as the service does."""

    def __init__(self, name: str) -> None:
        super().__init__(f"background task {name!r} ended")
        self.name = name


async def run_forever(work: Mapping[str, Coroutine[object, object, None]]) -> None:
    """Run tasks until cancelled; the first one that ends cancels the others.

    Args:
        work: Coroutines by task name.

    Raises:
        ExceptionGroup: Of a `TaskFailedError` that names the task; its cause is what the task
            raised.
    """
    async with asyncio.TaskGroup() as tasks:
        for name, coroutine in work.items():
            tasks.create_task(_forever(name, coroutine), name=name)


async def _forever(name: str, work: Coroutine[object, object, None]) -> None:
    """Await a coroutine that must not end, and name the task if it does."""
    try:
        await work
    except Exception as error:
        raise TaskFailedError(name) from error
    raise TaskFailedError(name)
