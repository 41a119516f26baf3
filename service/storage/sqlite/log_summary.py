"""What is in a file of the log, found without reading through it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import apsw

from domain.timebase import Duration, Instant
from service.storage.event_rows import EventRow


@dataclass(frozen=True, slots=True)
class LogSummary:
    """The extent of a file of the log; 0: there is none yet."""

    path: Path
    number: int
    last_batch: int = 0
    last_boot: int = 0
    last_at: Instant = 0
    next_step: int = 1
    first_wall_ns: int = 0
    wall_ns: int = 0
    """Wall time of its last batch."""
    running_ns: Duration = 0
    """For how long the service ran while it was written."""
    step_bytes: int = 0
    event_bytes: int = 0
    first_event: int = 0
    last_event: int = 0
    first_event_wall_ns: int = 0
    last_event_wall_ns: int = 0
    file_bytes: int = 0
    """Size of the file, once it is finished."""
    epochs: Mapping[str, int] = field(default_factory=dict)
    """Runs that are in it, by epoch, with the id of the last event of each; 0: it has none."""

    def with_events(self, rows: Sequence[EventRow]) -> "LogSummary":
        """Return the summary after more events."""
        if not rows:
            return self
        return replace(
            self,
            first_event=self.first_event or rows[0].id,
            last_event=rows[-1].id,
            first_event_wall_ns=self.first_event_wall_ns or rows[0].wall_ns,
            last_event_wall_ns=rows[-1].wall_ns,
        )


def summary_of(connection: apsw.Connection, path: Path, number: int) -> LogSummary:
    """Read what a file holds.

    Raises:
        apsw.Error: It cannot be read.
        KeyError: It lacks what every file begins with.
    """
    meta = dict(connection.execute("SELECT name, value FROM meta"))
    found = LogSummary(
        path,
        number,
        last_batch=meta["next_batch"] - 1,
        next_step=meta["next_step"],
        epochs=_epochs(connection),
    )
    return _with_event_range(connection, _with_batch_range(connection, found))


def _with_batch_range(connection: apsw.Connection, found: LogSummary) -> LogSummary:
    first = connection.execute("SELECT wall_ns FROM batches ORDER BY number LIMIT 1").get
    last = connection.execute(
        "SELECT number, boot, last_at, first_step + count, wall_ns, running_ns, step_bytes,"
        " event_bytes FROM batches ORDER BY number DESC LIMIT 1"
    ).get
    if last is None:
        return found
    number, boot, last_at, next_step, wall_ns, running_ns, step_bytes, event_bytes = last
    return replace(
        found,
        last_batch=number,
        last_boot=boot,
        last_at=last_at,
        next_step=next_step,
        first_wall_ns=first,
        wall_ns=wall_ns,
        running_ns=running_ns,
        step_bytes=step_bytes,
        event_bytes=event_bytes,
    )


def _with_event_range(connection: apsw.Connection, found: LogSummary) -> LogSummary:
    first = connection.execute("SELECT id, wall_ns FROM events ORDER BY id LIMIT 1").get
    last = connection.execute("SELECT id, wall_ns FROM events ORDER BY id DESC LIMIT 1").get
    if last is None:
        return found
    return replace(
        found,
        first_event=first[0],
        last_event=last[0],
        first_event_wall_ns=first[1],
        last_event_wall_ns=last[1],
    )


def _epochs(connection: apsw.Connection) -> dict[str, int]:
    # The ids of a run are those between its first one and the first one of the next run.
    rows = connection.execute(
        "SELECT epoch, coalesce((SELECT max(id) FROM events WHERE id >= first_event AND id < next),"
        " 0) FROM (SELECT epoch, number, first_event,"
        " lead(first_event, 1, 1 << 62) OVER (ORDER BY number) AS next FROM boots) ORDER BY number"
    )
    return {str(epoch): int(str(last)) for epoch, last in rows}
