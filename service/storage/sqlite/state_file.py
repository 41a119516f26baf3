"""The small file with what is kept at present, and how much of the log is in it.

It only saves reading: the log has all of it as well. It may lag behind the log after a loss of
power, and is brought up to it at the start.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import apsw
from pydantic_core import to_json

from service.storage.sqlite.batch import Changes, Key
from service.storage.sqlite.connection import WriteAheadLog, finish, new_file, open_to_write
from service.storage.sqlite.schema import STATE, bring_up, describe, examine

_CHECKPOINT_AT_PAGES = 100


@dataclass(frozen=True, slots=True)
class Applied:
    """The last change that is in the state."""

    log: int
    """Number of the file of the log."""
    change: int


class StateFile:
    """Used by the writer's thread alone."""

    def __init__(self, connection: apsw.Connection) -> None:
        self._connection = connection
        self._ahead = WriteAheadLog(connection, _CHECKPOINT_AT_PAGES)
        # The log's commit is what counts: this file needs no sync of its own.
        connection.execute("PRAGMA synchronous=NORMAL")

    @classmethod
    def open(cls, path: Path) -> "StateFile":
        """Open a file, and migrate it if it is of an earlier version.

        Raises:
            BrokenFileError: It is damaged.
            NewerFileError: A later version wrote it.
            apsw.Error: It cannot be read or written.
        """
        examine(path, STATE)
        connection = open_to_write(path)
        try:
            bring_up(connection, path, STATE)
            return cls(connection)
        except BaseException:
            connection.close(True)
            raise

    @classmethod
    def begin(
        cls, path: Path, robot: str, kept: Mapping[Key, bytes], applied: Applied
    ) -> "StateFile":
        """Make a new file.

        Raises:
            apsw.Error: It cannot be written.
        """
        with new_file(path) as connection:
            bring_up(connection, path, STATE)
            describe(connection, robot=robot)
            _apply(connection, dict(kept), applied)
        return cls(open_to_write(path))

    def applied(self) -> Applied:
        """Return how much of the log is in it."""
        meta = dict(self._connection.execute("SELECT name, value FROM meta"))
        return Applied(meta["applied_log"], meta["applied_change"])

    def kept(self) -> dict[Key, bytes]:
        """Return all that is kept."""
        rows = self._connection.execute("SELECT kind, name, value FROM current ORDER BY rowid")
        return {(kind, name): value for kind, name, value in rows}

    def apply(self, changes: Changes, applied: Applied) -> None:
        """Bring it up to a change of the log.

        Raises:
            apsw.Error: It cannot be written.
        """
        with self._connection:
            _apply(self._connection, changes, applied)
        self._ahead.tidy()

    def finish(self) -> None:
        """Close it as one plain file."""
        finish(self._connection)

    def close(self) -> None:
        """Close it after a failure."""
        self._connection.close(True)


_DELETE = """
DELETE FROM current WHERE (kind, name) IN
  (SELECT value ->> 0, value ->> 1 FROM json_each(?) WHERE value ->> 2 IS NULL)
"""
_SET = """
INSERT INTO current
SELECT value ->> 0, value ->> 1, CAST(value ->> 2 AS BLOB) FROM json_each(?)
WHERE value ->> 2 IS NOT NULL
ON CONFLICT (kind, name) DO UPDATE SET value = excluded.value
"""
"""One statement for all: each gives the interpreter's lock away, and a commit may be waiting."""


def _apply(connection: apsw.Connection, changes: Changes, applied: Applied) -> None:
    rows = to_json([(*key, value) for key, value in changes.items()]).decode()
    connection.execute(_DELETE, (rows,))
    connection.execute(_SET, (rows,))
    connection.execute(
        "INSERT OR REPLACE INTO meta VALUES ('applied_log', ?), ('applied_change', ?)",
        (applied.log, applied.change),
    )
