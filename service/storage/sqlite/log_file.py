"""One file of the log. The newest is written; the others stay as they are until they are dropped.

Each file stands for itself: it begins with the run that goes on in it, and with all that is kept.
"""

import time
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import apsw
from pydantic_core import to_json

from domain.timebase import Duration, seconds
from service.storage.journal import Boot
from service.storage.sqlite.batch import Batch, Changes, Flight, Key
from service.storage.sqlite.connection import WriteAheadLog, finish, new_file, open_to_write
from service.storage.sqlite.log_summary import LogSummary, summary_of
from service.storage.sqlite.packing import DictionaryMaker, pack
from service.storage.sqlite.schema import LOG, bring_up, describe, examine

_COMPRESSION = 1
_CHECKPOINT_AT_PAGES = 4_000
"""16 MiB. Commits wait while they are taken into the file, some ms for these as for fewer, since
most of them are the same few pages again."""
_SYNC_EVERY: Duration = seconds(0.5)
"""What nobody waits for may be lost with the power for so long."""


@dataclass(frozen=True, slots=True)
class Run:
    """A run of the service as the log knows it."""

    number: int
    boot: Boot
    wall_ns: int
    """Wall time of its start."""


_ROWS_AT_ONCE = 1_000
"""So many events are made to one JSON text, which holds the interpreter's lock for some 2 ms."""

_NOTED = """
CREATE TEMP VIEW noted (boot, events, changes) AS SELECT NULL, NULL, NULL;
CREATE TEMP TRIGGER note INSTEAD OF INSERT ON noted BEGIN
  INSERT OR REPLACE INTO events
  SELECT value ->> 0, NEW.boot, value ->> 1, value ->> 2, value ->> 3, value ->> 4, value ->> 5,
    value ->> 7, value ->> 8, value ->> 9
  FROM json_each(NEW.events);
  INSERT OR IGNORE INTO event_parts
  SELECT part.value, event.value ->> 0
  FROM json_each(NEW.events) AS event, json_each(event.value, '$[6]') AS part;
  INSERT INTO changes (kind, name, value)
  SELECT value ->> 0, value ->> 1, CAST(value ->> 2 AS BLOB) FROM json_each(NEW.changes);
END;
CREATE TEMP VIEW flights (
  number, boot, first_step, count, first_at, last_at, wall_ns, packed, steps,
  running_ns, step_bytes, event_bytes, events, changes
) AS SELECT NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL;
CREATE TEMP TRIGGER fly INSTEAD OF INSERT ON flights BEGIN
  INSERT INTO batches VALUES (
    NEW.number, NEW.boot, NEW.first_step, NEW.count, NEW.first_at, NEW.last_at, NEW.wall_ns,
    NEW.packed, NEW.steps, NEW.running_ns, NEW.step_bytes, NEW.event_bytes
  );
  INSERT INTO noted VALUES (NEW.boot, NEW.events, NEW.changes);
END;
"""
"""Each insertion into these views is one statement, whatever it writes.

`events` are rows in the order of the fields of `EventRow`, `changes` are kind, name and value.
Each statement gives the interpreter's lock away and has to get it back, for which it waits while
the loop is busy. What is one statement is a transaction by itself, too.
"""
_INSERT_NOTED = "INSERT INTO noted VALUES (?, ?, '[]')"
_NO_CHANGES: Changes = {}
_INSERT_FLIGHT = "INSERT INTO flights VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?)"


class LogFile:
    """The newest file of the log; used by the writer's thread alone."""

    def __init__(self, path: Path, number: int, connection: apsw.Connection) -> None:
        self.path = path
        self.number = number
        self._connection = connection
        self._ahead = WriteAheadLog(connection, _CHECKPOINT_AT_PAGES)
        self._synced_at = 0
        self._is_synced = True
        self.summary = summary_of(connection, path, number)
        self.dictionary: bytes = _dictionary(connection)
        """Of its steps; empty as long as there were too few."""
        self.first_size = 0
        """Of what it began with, in bytes; 0 if it was begun by an earlier run."""
        self._maker = DictionaryMaker()
        self.last_change: int = _number(connection, "SELECT max(number) FROM changes")
        connection.execute(_NOTED)

    @classmethod
    def open(cls, path: Path, number: int) -> "LogFile":
        """Open a file, and migrate it if it is of an earlier version.

        Raises:
            BrokenFileError: It is damaged, or it was never begun.
            NewerFileError: A later version wrote it.
            apsw.Error: It cannot be read or written.
        """
        examine(path, LOG)
        connection = open_to_write(path)
        try:
            bring_up(connection, path, LOG)
            return cls(path, number, connection)
        except BaseException:
            connection.close(True)
            raise

    @classmethod
    def begin(
        cls,
        path: Path,
        number: int,
        robot: str,
        run: Run,
        kept: Mapping[Key, bytes],
        next_: "Next",
        dictionary: bytes = b"",
    ) -> "LogFile":
        """Make a new file, complete or not at all.

        Args:
            path: Where it will be.
            number: Of the file.
            robot: Name of the robot.
            run: The run that goes on in it.
            kept: All that is kept.
            next_: Where the log goes on.
            dictionary: Of the file before it.

        Raises:
            apsw.Error: It cannot be written.
        """
        with new_file(path) as connection:
            bring_up(connection, path, LOG)
            describe(
                connection,
                robot=robot,
                next_step=next_.step,
                next_batch=next_.batch,
                dictionary=dictionary,
            )
            _insert_run(connection, run, next_)
            _insert_changes(connection, kept.items())
        file = cls(path, number, open_to_write(path))
        file.first_size = file.size()
        return file

    def begin_run(self, run: Run, changes: Changes, next_: "Next") -> None:
        """Write down that a run begins, and what it keeps from the start on."""
        self._set_sync(True)
        with self._connection:
            _insert_run(self._connection, run, next_)
            _insert_changes(self._connection, changes.items())
        self._count_changes(changes)

    def write(self, flight: Flight, run: Run, changes: Changes) -> None:
        """Write batches down, without those that an attempt that failed wrote all the same.

        Args:
            flight: What to write.
            run: The run that it belongs to.
            changes: What changes of what is kept.

        Raises:
            apsw.Error: Nothing was written, or nobody knows.
        """
        now = time.monotonic_ns()
        is_synced = flight.must_last or now - self._synced_at >= _SYNC_EVERY
        self._set_sync(is_synced)
        if self._is_one_statement(flight, changes):
            self.summary = self._insert(flight.batches[0], run, self.summary, changes)
        else:
            self.summary, self.dictionary = self._insert_all(flight, run, changes)
        self._count_changes(changes)
        if is_synced:
            self._synced_at = now

    def changes_after(self, number: int) -> Iterable[tuple[str, str, bytes | None]]:
        """Return kind, name and value of what changed after a change."""
        sql = "SELECT kind, name, value FROM changes WHERE number > ? ORDER BY number"
        return self._connection.execute(sql, (number,))

    def tidy(self) -> None:
        """Take what is in the write-ahead log into the file, if that is worth it."""
        self._ahead.tidy()

    def size(self) -> int:
        """Return its size on disk, in bytes."""
        wal = self.path.with_name(f"{self.path.name}-wal")
        return self.path.stat().st_size + (wal.stat().st_size if wal.exists() else 0)

    def finish(self) -> None:
        """Close it as one plain file."""
        finish(self._connection)

    def close(self) -> None:
        """Close it after a failure."""
        self._connection.close(True)

    def _set_sync(self, is_synced: bool) -> None:
        if is_synced is not self._is_synced:
            self._connection.execute(f"PRAGMA synchronous={'FULL' if is_synced else 'NORMAL'}")
            self._is_synced = is_synced

    def _count_changes(self, changes: Changes) -> None:
        self.last_change += len(changes)

    def _next_dictionary(self, flight: Flight) -> bytes:
        """Return the dictionary of later flights; it is written once there is one."""
        if self.dictionary:
            return self.dictionary
        dictionary = self._maker.see([step for batch in flight.batches for step in batch.steps])
        if dictionary:
            sql = "INSERT OR REPLACE INTO meta VALUES ('dictionary', ?)"
            self._connection.execute(sql, (dictionary,))
        return dictionary

    def _is_one_statement(self, flight: Flight, changes: Changes) -> bool:
        """Tell whether all of a flight fits into one row of `flights`, as it usually does."""
        batch = flight.batches[0]
        return (
            len(flight.batches) == 1
            and batch.number > self.summary.last_batch
            and not (batch.hole or batch.checkpoints or batch.ends_run)
            and bool(self.dictionary)
            and max(len(batch.events), len(changes)) <= _ROWS_AT_ONCE
        )

    def _insert_all(self, flight: Flight, run: Run, changes: Changes) -> tuple[LogSummary, bytes]:
        """Insert a flight in a transaction; return summary and dictionary after it."""
        summary, dictionary = self.summary, self.dictionary
        with self._connection:
            for batch in flight.batches:
                if batch.number > self.summary.last_batch:
                    summary = self._insert(batch, run, summary)
                    self._insert_rest(batch, run, summary)
                _insert_hole(self._connection, batch, run)
            _insert_changes(self._connection, changes.items())
            dictionary = self._next_dictionary(flight)
        return summary, dictionary

    def _insert(
        self, batch: Batch, run: Run, so_far: LogSummary, changes: Changes = _NO_CHANGES
    ) -> LogSummary:
        """Insert a batch by one statement, with its first events."""
        steps = pack(batch.steps, self.dictionary)
        event_bytes = sum(len(row.data) + len(row.words) for row in batch.events)
        now = replace(
            _advanced(so_far, batch, run),
            last_batch=batch.number,
            next_step=batch.first_step + len(batch.steps),
            step_bytes=so_far.step_bytes + len(steps),
            event_bytes=so_far.event_bytes + event_bytes,
        )
        self._connection.execute(
            _INSERT_FLIGHT,
            (
                *(batch.number, run.number, batch.first_step, len(batch.steps), batch.first_at),
                *(now.last_at, now.wall_ns, bool(self.dictionary), steps),
                *(now.running_ns, now.step_bytes, now.event_bytes),
                to_json(batch.events[:_ROWS_AT_ONCE]).decode(),
                to_json([(*key, value) for key, value in changes.items()]).decode(),
            ),
        )
        return now.with_events(batch.events)

    def _insert_rest(self, batch: Batch, run: Run, now: LogSummary) -> None:
        """Insert what few batches have."""
        for first in range(_ROWS_AT_ONCE, len(batch.events), _ROWS_AT_ONCE):
            rows = to_json(batch.events[first : first + _ROWS_AT_ONCE]).decode()
            self._connection.execute(_INSERT_NOTED, (run.number, rows))
        for taken in batch.checkpoints:
            state = zlib.compress(taken.state, _COMPRESSION)
            self._connection.execute(
                "INSERT OR REPLACE INTO checkpoints VALUES (?,?,?,?,?,?)",
                (taken.step, batch.number, run.number, taken.at, run.boot.version, state),
            )
        if batch.ends_run:
            self._connection.execute(
                "UPDATE boots SET ended_wall_ns = ? WHERE number = ?", (now.wall_ns, run.number)
            )


@dataclass(frozen=True, slots=True)
class Next:
    """The first numbers that are not used yet."""

    step: int = 1
    batch: int = 1
    event: int = 1


def _advanced(so_far: LogSummary, batch: Batch, run: Run) -> LogSummary:
    """Return the times of a file after one more batch."""
    if not batch.steps:
        return so_far
    since = so_far.last_at if so_far.last_boot == run.number else batch.first_at
    return replace(
        so_far,
        last_boot=run.number,
        last_at=batch.last_at,
        first_wall_ns=so_far.first_wall_ns or batch.wall_ns,
        wall_ns=batch.wall_ns,
        running_ns=so_far.running_ns + max(0, batch.last_at - since),
    )


def _insert_run(connection: apsw.Connection, run: Run, next_: Next) -> None:
    boot = run.boot
    texts = (zlib.compress(text.encode()) for text in (boot.model, boot.robot))
    connection.execute(
        "INSERT OR IGNORE INTO boots VALUES (?,?,?,?,?,?,?,?,?,NULL)",
        (
            *(run.number, boot.epoch, boot.version, boot.started_at, run.wall_ns),
            *(*texts, next_.batch, next_.event),
        ),
    )


def _insert_changes(
    connection: apsw.Connection, changes: Iterable[tuple[Key, bytes | None]]
) -> None:
    connection.executemany(
        "INSERT INTO changes (kind, name, value) VALUES (?,?,?)",
        ((*key, value) for key, value in changes),
    )


def _insert_hole(connection: apsw.Connection, batch: Batch, run: Run) -> None:
    """Write down what was lost after a batch; that may have grown since an attempt that failed."""
    hole = batch.hole
    if hole is not None:
        connection.execute(
            "INSERT OR REPLACE INTO holes VALUES (?,?,?,?,?,?,?,?)",
            (
                *(batch.number, run.number, hole.after_step, hole.steps, hole.events),
                *(hole.from_at, hole.to_at, hole.reason),
            ),
        )


def _dictionary(connection: apsw.Connection) -> bytes:
    found = connection.execute("SELECT value FROM meta WHERE name = 'dictionary'").get
    return found if isinstance(found, bytes) else b""


def _number(connection: apsw.Connection, sql: str) -> int:
    return int(connection.execute(sql).get or 0)
