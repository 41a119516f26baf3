"""Reads events from the files of the log, also while they are written."""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import apsw

from service.clock import since_epoch
from service.storage.event_rows import EventRow, stored_event
from service.storage.journal import EventQuery, StoredEvent
from service.storage.kind_pattern import KindPattern
from service.storage.sqlite.connection import reading
from service.storage.sqlite.log_summary import LogSummary

_KINDS = """
WITH RECURSIVE found (kind) AS (
    SELECT min(kind) FROM events
    UNION ALL
    SELECT (SELECT min(kind) FROM events WHERE kind > found.kind) FROM found
    WHERE found.kind IS NOT NULL
)
SELECT kind FROM found WHERE kind IS NOT NULL
"""
_LARGEST = 2**63 - 1
_COLUMNS = (
    "events.id, events.boot, boots.epoch, events.at, events.wall_ns, events.kind, events.cause,"
    " events.actor, events.data, events.words, events.notable"
)


def read_events(files: Sequence[LogSummary], query: EventQuery) -> list[StoredEvent]:
    """Return the events of the log that a query asks for, in the order of their ids.

    Args:
        files: Files of the log, oldest first; the last may hold more than its summary says.
        query: Without `after`, the newest are returned.

    Raises:
        apsw.Error: They cannot be read.
    """
    is_forward = query.after is not None
    found: list[StoredEvent] = []
    current = files[-1] if files else None
    for file in files if is_forward else reversed(files):
        if len(found) < query.limit and (file is current or _may_hold(file, query)):
            found += _read_file(file.path, query, query.limit - len(found))
    return found if is_forward else found[::-1]


def _may_hold(file: LogSummary, query: EventQuery) -> bool:
    if not file.last_event:
        return False
    if query.after is not None and file.last_event <= query.after:
        return False
    return query.before is None or file.first_event < query.before


def _read_file(path: Path, query: EventQuery, limit: int) -> list[StoredEvent]:
    with suppress(FileNotFoundError), reading(path) as connection:
        conditions, values = _conditions(connection, query)
        order = "DESC" if query.after is None else "ASC"
        where = f"WHERE {' AND '.join(conditions)}" if conditions else ""
        rows = connection.execute(
            f"SELECT {_COLUMNS} FROM events JOIN boots ON boots.number = events.boot"
            f" {where} ORDER BY events.id {order} LIMIT ?",
            (*values, limit),
        )
        return [_event(row) for row in rows]
    # It was dropped a moment ago.
    return []


def _conditions(connection: apsw.Connection, query: EventQuery) -> tuple[list[str], list[Any]]:
    conditions: list[str] = []
    values: list[Any] = []

    def require(condition: str, *needed: object) -> None:
        conditions.append(condition)
        values.extend(needed)

    if query.after is not None:
        require("events.id > ?", _bound(query.after))
    if query.before is not None:
        require("events.id < ?", _bound(query.before))
    if query.from_at is not None:
        require("events.wall_ns >= ?", _bound(since_epoch(query.from_at)))
    if query.to_at is not None:
        require("events.wall_ns <= ?", _bound(since_epoch(query.to_at)))
    if query.kind is not None:
        kinds = _kinds(connection, query.kind)
        require(f"events.kind IN ({','.join('?' * len(kinds))})", *kinds)
    if query.actor is not None:
        require("events.actor = ?", query.actor)
    if query.part is not None:
        require("events.id IN (SELECT event FROM event_parts WHERE part = ?)", query.part)
    return conditions, values


def _bound(number: int) -> int:
    """Return a number as SQLite can hold it."""
    return max(-_LARGEST, min(_LARGEST, number))


def _kinds(connection: apsw.Connection, kind: str) -> Sequence[str]:
    pattern = KindPattern(kind)
    known: Iterable[str] = (row[0] for row in connection.execute(_KINDS))
    return [name for name in known if pattern.matches(name)]


def _event(row: tuple[Any, ...]) -> StoredEvent:
    number, boot, epoch, at, wall_ns, kind, cause, actor, data, words, notable = row
    found = EventRow(number, at, wall_ns, kind, cause, actor, (), data, words, bool(notable))
    return stored_event(found, boot, epoch)
