"""Tasks over a restart of the service: what is kept of them and when, and how they come back."""

from collections.abc import Sequence

from domain.events.driving import TASK_ENDS
from domain.identifiers import TaskId
from domain.kept import Kept, KeptProgress, KeptTask
from domain.outbox import Outbox
from domain.tasks.task import Task
from domain.timebase import Duration, Instant, seconds

LOST_AT_MOST: Duration = seconds(0.5)
"""If the service dies, the progress of no more driving than this is lost."""

_KEEP_EVERY: Duration = seconds(0.25)
"""Leaves as much time until it is on disk."""
_ENDS = {phase.value: phase for phase in TASK_ENDS}


class TaskKeeper:
    """Keeps tasks: the path once, the progress often while a task is driven."""

    def __init__(self, outbox: Outbox) -> None:
        self._outbox = outbox
        self._kept_at: Instant | None = None

    def add(self, task: Task) -> None:
        """Keep a new task."""
        self._outbox.keep(
            KeptTask(
                task.id,
                task.path,
                task.controller,
                task.speed_mps,
                task.start_index,
                task.created_at,
                task.cause,
            )
        )

    def note(self, task: Task, now: Instant) -> None:
        """Keep how far a task got, and how it ended."""
        self._kept_at = now
        has_ended = task.ended_at is not None
        self._outbox.keep(
            KeptProgress(
                task.id,
                task.has_run,
                task.target_index,
                task.distance_m,
                task.left_out_m,
                task.cross_track_error_m,
                ended_as=task.phase.value if has_ended else None,
                reason=task.reason if has_ended else None,
                ended_at=task.ended_at,
                seen=None if has_ended else task.seen,
            )
        )

    def note_driven(self, task: Task, now: Instant) -> None:
        """Keep how far a task got, unless that was kept a moment ago."""
        if self._kept_at is None or now - self._kept_at >= _KEEP_EVERY:
            self.note(task, now)

    def forget(self, identity: TaskId) -> None:
        """Keep a task no longer."""
        self._outbox.forget(KeptTask, identity)
        self._outbox.forget(KeptProgress, identity)


def tasks_of(kept: Sequence[Kept], now: Instant) -> tuple[list[Task], dict[TaskId, str]]:
    """Return the tasks that were kept, the oldest first.

    Args:
        kept: All that was kept.
        now: The current time; no time that was kept is later.

    Returns:
        The tasks, those that have not ended as paused ones; and by id why others do not come back.
    """
    progress = {item.task: item for item in kept if isinstance(item, KeptProgress)}
    asked = sorted(
        (item for item in kept if isinstance(item, KeptTask)),
        key=lambda item: (len(item.id), item.id),
    )
    tasks: list[Task] = []
    left_out: dict[TaskId, str] = {}
    for item in asked:
        driven = progress.get(item.id)
        if why := _why_not(item, driven):
            left_out[item.id] = why
        else:
            tasks.append(_task(item, driven, now))
    return tasks, left_out


def _why_not(kept: KeptTask, progress: KeptProgress | None) -> str:
    """Return why a task does not come back, in words; empty: it does."""
    count = kept.path.count
    reached = kept.start_index if progress is None else progress.target_index
    if not (0 <= kept.start_index < count - 1 and kept.start_index <= reached < count):
        return "its path has no such waypoint"
    if progress is not None and progress.ended_as not in (None, *_ENDS):
        return f"this version knows no {progress.ended_as} as an end"
    return ""


def _task(kept: KeptTask, progress: KeptProgress | None, now: Instant) -> Task:
    created_at = min(kept.created_at, now)
    task = Task(
        kept.id,
        kept.path,
        kept.controller,
        kept.speed_mps,
        kept.start_index,
        created_at,
        kept.cause,
    )
    if progress is None:
        return task
    task.has_run = progress.has_run
    task.target_index = progress.target_index
    task.distance_m, task.left_out_m = progress.distance_m, progress.left_out_m
    task.cross_track_error_m = progress.cross_track_error_m
    task.seen = progress.seen
    if progress.ended_as is not None:
        ended_at = created_at if progress.ended_at is None else min(progress.ended_at, now)
        task.end(_ENDS[progress.ended_as], progress.reason, ended_at)
    return task
