"""Versions of the files, and the numbered steps from one to the next.

`user_version` of a file is the number of steps that it has been through. A step is never changed
once it is released; a new one is appended, and the tests get a stored file of the one before it.
Kinds of kept values, of events and of inputs are data: they need no step.
"""

import os
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

import apsw

from service.codec.codec import VERSION
from service.storage.sqlite.connection import reading

Steps: TypeAlias = Sequence[str]
"""SQL of each step, from an empty file on."""

STATE: Steps = (
    """
    CREATE TABLE meta (name TEXT PRIMARY KEY, value) WITHOUT ROWID;
    CREATE TABLE current (
        kind TEXT NOT NULL, name TEXT NOT NULL, value BLOB NOT NULL, UNIQUE (kind, name)
    );
    """,
)

LOG: Steps = (
    """
    CREATE TABLE meta (name TEXT PRIMARY KEY, value) WITHOUT ROWID;
    -- Runs of the service that are in this file.
    CREATE TABLE boots (
        number INTEGER PRIMARY KEY, epoch TEXT NOT NULL, version TEXT NOT NULL,
        started_at INTEGER NOT NULL, wall_ns INTEGER NOT NULL,
        model BLOB NOT NULL, robot BLOB NOT NULL, first_batch INTEGER NOT NULL,
        first_event INTEGER NOT NULL, ended_wall_ns INTEGER
    );
    -- One row per batch. `steps` are lines of JSON, compressed by zlib; if `packed`, with the
    -- dictionary in `meta`. The last three are sums over the file, so that its last row sums it up.
    CREATE TABLE batches (
        number INTEGER PRIMARY KEY, boot INTEGER NOT NULL, first_step INTEGER NOT NULL,
        count INTEGER NOT NULL, first_at INTEGER NOT NULL, last_at INTEGER NOT NULL,
        wall_ns INTEGER NOT NULL, packed INTEGER NOT NULL, steps BLOB NOT NULL,
        running_ns INTEGER NOT NULL, step_bytes INTEGER NOT NULL, event_bytes INTEGER NOT NULL
    );
    CREATE TABLE events (
        id INTEGER PRIMARY KEY, boot INTEGER NOT NULL, at INTEGER NOT NULL,
        wall_ns INTEGER NOT NULL, kind TEXT NOT NULL, cause INTEGER, actor TEXT NOT NULL,
        data TEXT NOT NULL, words TEXT NOT NULL, notable INTEGER NOT NULL
    );
    CREATE INDEX events_by_kind ON events (kind);
    CREATE INDEX events_by_actor ON events (actor) WHERE actor != '';
    CREATE INDEX events_by_wall ON events (wall_ns);
    CREATE TABLE event_parts (
        part TEXT NOT NULL, event INTEGER NOT NULL, PRIMARY KEY (part, event)
    ) WITHOUT ROWID;
    -- What is kept: first all of it as it was when the file was begun, then what changed.
    -- NULL: kept no longer.
    CREATE TABLE changes (
        number INTEGER PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL, value BLOB
    );
    -- State of the core after a step, compressed by zlib, and the batch that holds that step.
    CREATE TABLE checkpoints (
        step INTEGER PRIMARY KEY, batch INTEGER NOT NULL, boot INTEGER NOT NULL,
        at INTEGER NOT NULL, version TEXT NOT NULL, state BLOB NOT NULL
    );
    -- Steps that were lost at the end of a batch.
    CREATE TABLE holes (
        batch INTEGER PRIMARY KEY, boot INTEGER NOT NULL, after_step INTEGER NOT NULL,
        steps INTEGER NOT NULL, events INTEGER NOT NULL,
        from_at INTEGER NOT NULL, to_at INTEGER NOT NULL, reason TEXT NOT NULL
    );
    """,
)

APPLICATION_ID = 0x50494C54
"""Marks the files as ours for `file` and others: PILT."""
_SPARE_BYTES = 4 * 2**20
"""Free space that a migration leaves, beside twice the size of the file."""


class BrokenFileError(Exception):
    """A file does not hold what it should."""


class NewerFileError(Exception):
    """A later version of Pilothouse wrote this file."""


class NoSpaceError(OSError):
    """There is not enough free space to migrate a file."""


def version_of(connection: apsw.Connection) -> int:
    """Return how many steps a file has been through; 0: it is empty."""
    return int(connection.pragma("user_version"))


def describe(connection: apsw.Connection, **meta: object) -> None:
    """Write down what a new file is; the version of its records is added."""
    connection.executemany("INSERT INTO meta VALUES (?, ?)", [*meta.items(), ("records", VERSION)])


def bring_up(connection: apsw.Connection, path: Path, steps: Steps) -> None:
    """Take a file through the steps that it lacks: all of them, or none.

    Raises:
        NoSpaceError: There is not enough free space.
        apsw.Error: It cannot be written.
    """
    version = version_of(connection)
    if version >= len(steps):
        return
    if version:
        _require_space(path)
    with connection:
        for step in steps[version:]:
            connection.execute(step)
        connection.pragma("application_id", APPLICATION_ID)
        connection.pragma("user_version", len(steps))


def examine(path: Path, steps: Steps) -> None:
    """Check that a file is whole, and that this release can read it; change nothing.

    Raises:
        BrokenFileError: It is damaged, or it is empty.
        NewerFileError: It is of a later version, or holds records of one.
        apsw.Error: It cannot be read, or it is no database.
    """
    with reading(path) as connection:
        version = version_of(connection)
        if not version:
            raise BrokenFileError("it is empty")
        if version > len(steps):
            raise NewerFileError(f"version {version} of the file; this release knows {len(steps)}")
        found = connection.pragma("quick_check")
        if found != "ok":
            raise BrokenFileError(str(found))
        records = connection.execute("SELECT value FROM meta WHERE name = 'records'").get
        if not isinstance(records, int) or records > VERSION:
            raise NewerFileError(f"records of version {records}; this release knows {VERSION}")


def _require_space(path: Path) -> None:
    needed = 2 * os.stat(path).st_size + _SPARE_BYTES
    free = shutil.disk_usage(path.parent).free
    if free < needed:
        raise NoSpaceError(f"{path.name} needs {needed} bytes to be migrated; {free} are free")
