"""Files of the log, written without a journal."""

from pathlib import Path

from domain.timebase import Instant
from service.storage.event_rows import EventRow, event_row
from service.storage.sqlite.batch import Batch, Changes, Flight
from service.storage.sqlite.log_file import LogFile, Next, Run
from tests.support.noted_robot import boot, hold_set

NO_CHANGES: Changes = {}


def run(number: int = 1) -> Run:
    """Return a run of the service."""
    return Run(number, boot(number), 1_000 * number)


def log_file(path: Path, next_: Next = Next(), number: int = 1) -> LogFile:  # noqa: B008
    """Begin a file of the log."""
    return LogFile.begin(path, number, "robot", run(), {("kept_hold", "old"): b"old"}, next_)


def row(number: int, at: Instant = 0) -> EventRow:
    """Return an event."""
    return event_row(hold_set(number, at), 1_000 * number)


def batch(
    number: int, first_step: int, *steps: bytes, at: Instant = 0, events: tuple[int, ...] = ()
) -> Batch:
    """Return a batch of steps that begin at a time, 10 ns apart."""
    last_at = at + 10 * max(0, len(steps) - 1)
    rows = [row(event, at) for event in events]
    return Batch(number, first_step, list(steps), at, last_at, 1_000 * number, rows)


def flight(*batches: Batch, must_last: bool = True) -> Flight:
    """Return batches as the writer gets them."""
    return Flight(batches, must_last)
