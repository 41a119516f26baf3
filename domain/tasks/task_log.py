"""The tasks that are kept: the current one, and ended ones up to a limit."""

from collections.abc import Iterator

from domain.errors import UnknownTaskError
from domain.identifiers import TaskId
from domain.tasks.task import Task

MAX_KEPT = 100
MAX_KEPT_POINTS = 300_000
"""Waypoints of all kept tasks together; some 20 MB."""


class TaskLog:
    """Tasks by id; the oldest are dropped first."""

    def __init__(self) -> None:
        self._tasks: dict[str, Task] = {}

    def add(self, task: Task) -> list[TaskId]:
        """Add a task, and drop the oldest ones beyond the limits; the newest is always kept.

        Returns:
            The ids of those that were dropped.
        """
        self._tasks[task.id] = task
        dropped = []
        points = sum(kept.path.count for kept in self._tasks.values())
        while len(self._tasks) > 1 and (len(self._tasks) > MAX_KEPT or points > MAX_KEPT_POINTS):
            forgotten = self._tasks.pop(next(iter(self._tasks)))
            points -= forgotten.path.count
            dropped.append(forgotten.id)
        return dropped

    def get(self, identity: str) -> Task:
        """Return a task.

        Raises:
            UnknownTaskError: The id is unknown, or the task is no longer kept.
        """
        task = self._tasks.get(identity)
        if task is None:
            raise UnknownTaskError("task", identity, tuple(reversed(self._tasks)))
        return task

    def newest_first(self) -> Iterator[Task]:
        """Yield all kept tasks."""
        return reversed(self._tasks.values())
