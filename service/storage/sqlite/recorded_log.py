"""Reads the log of a folder, in any process and also while a service writes it."""

import zlib
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Any

from domain.timebase import Instant
from service.clock import to_datetime
from service.storage.errors import UnusableFolderError
from service.storage.journal import Boot, EventQuery, StoredEvent
from service.storage.sqlite.connection import FAILURES, reading, words
from service.storage.sqlite.log_summary import LogSummary, summary_of
from service.storage.sqlite.packing import unpack
from service.storage.sqlite.places import Places
from service.storage.sqlite.reading import read_events
from service.storage.sqlite.schema import LOG, version_of


@dataclass(frozen=True, slots=True)
class RecordedRun:
    """A run of the service that is in the log, or the part of it that still is."""

    number: int
    boot: Boot
    first_step: int
    """Number of its first step that is in the log."""
    ended_at: datetime | None
    """When it ended; None: it was killed, or it goes on."""


@dataclass(frozen=True, slots=True)
class RecordedCheckpoint:
    """A state of the core that a replay can start from."""

    run: int
    step: int
    """Number of the step that it follows."""
    at: Instant
    version: str
    """Version of Pilothouse that can read it."""


@dataclass(frozen=True, slots=True)
class RecordedHole:
    """Steps that were lost."""

    run: int
    after_step: int
    """Number of the last step before them."""
    steps: int
    events: int
    from_at: Instant
    to_at: Instant
    reason: str


class RecordedLog:
    """The log as it is when each method is called.

    Args:
        folder: The folder of a robot.

    Raises:
        UnusableFolderError: There is no log that this version can read.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._places = Places(folder)
        if not self._places.logs.is_dir() or not self._places.log_numbers():
            raise UnusableFolderError(f"{folder} holds no log")
        for path in self._paths():
            self._check(path)

    def runs(self) -> Sequence[RecordedRun]:
        """Return the runs in the log, oldest first."""
        found: dict[int, RecordedRun] = {}
        for path in self._paths():
            for row in self._rows(path, _RUNS):
                run = _run(row)
                earlier = found.get(run.number)
                first_step = run.first_step if earlier is None else earlier.first_step
                found[run.number] = replace(run, first_step=first_step)
        return [found[number] for number in sorted(found)]

    def lines(self, run: int, after_step: int = 0) -> Iterator[tuple[int, bytes]]:
        """Yield the steps of a run in order, each with its number; `STEPS` of the codec reads them.

        Args:
            run: Number of the run.
            after_step: Number of the last step that is not wanted.
        """
        for path in self._paths():
            for first, packed, dictionary in self._rows(path, _STEPS, run, after_step):
                for offset, line in enumerate(unpack(packed, dictionary)):
                    if first + offset > after_step:
                        yield first + offset, line

    def checkpoints(self) -> Sequence[RecordedCheckpoint]:
        """Return the checkpoints in the log, oldest first."""
        return [
            RecordedCheckpoint(*row)
            for path in self._paths()
            for row in self._rows(path, _CHECKPOINTS)
        ]

    def state(self, checkpoint: RecordedCheckpoint) -> bytes:
        """Return the state of the core that `Journal.checkpoint` was given.

        Raises:
            UnusableFolderError: The file that held it was dropped.
        """
        for path in self._paths():
            sql = "SELECT state FROM checkpoints WHERE step = ?"
            for (state,) in self._rows(path, sql, checkpoint.step):
                return zlib.decompress(state)
        raise UnusableFolderError(f"{self._folder} no longer holds that checkpoint")

    def holes(self) -> Sequence[RecordedHole]:
        """Return what is missing, oldest first."""
        return [RecordedHole(*row) for path in self._paths() for row in self._rows(path, _HOLES)]

    def events(self, query: EventQuery) -> Sequence[StoredEvent]:
        """Return events in the order of their ids."""
        return read_events([self._summary(path) for path in self._paths()], query)

    def _paths(self) -> Sequence[Path]:
        return [self._places.log(number) for number in self._places.log_numbers()]

    def _check(self, path: Path) -> None:
        try:
            with reading(path) as connection:
                version = version_of(connection)
        except FAILURES as error:
            raise UnusableFolderError(f"{path} cannot be read: {words(error)}") from error
        if version != len(LOG):
            raise UnusableFolderError(
                f"{path} has version {version}, this release reads {len(LOG)};"
                " a service that is started on the folder brings older files up to date"
            )

    def _rows(self, path: Path, sql: str, *values: object) -> Iterator[tuple[Any, ...]]:
        # It may have been dropped a moment ago.
        with suppress(FileNotFoundError), reading(path) as connection:
            yield from connection.execute(sql, values)

    def _summary(self, path: Path) -> LogSummary:
        with reading(path) as connection:
            return summary_of(connection, path, int(path.stem))


_RUNS = (
    "SELECT number, epoch, version, started_at, wall_ns, model, robot, ended_wall_ns,"
    " coalesce((SELECT first_step FROM batches WHERE number >= first_batch AND count > 0"
    " ORDER BY number LIMIT 1), 0) FROM boots ORDER BY number"
)
_STEPS = (
    "SELECT first_step, steps,"
    " CASE WHEN packed THEN (SELECT value FROM meta WHERE name = 'dictionary') ELSE x'' END"
    " FROM batches WHERE number >="
    " (SELECT first_batch FROM boots WHERE boots.number = ?1) AND boot = ?1 AND count > 0"
    " AND first_step + count > ?2 + 1 ORDER BY number"
)
_CHECKPOINTS = "SELECT boot, step, at, version FROM checkpoints ORDER BY step"
_HOLES = "SELECT boot, after_step, steps, events, from_at, to_at, reason FROM holes ORDER BY batch"


def _run(row: tuple[Any, ...]) -> RecordedRun:
    number, epoch, version, started_at, wall_ns, model, robot, ended, first_step = row
    boot = Boot(epoch, version, started_at, to_datetime(wall_ns), _text(model), _text(robot))
    return RecordedRun(number, boot, first_step, None if ended is None else to_datetime(ended))


def _text(compressed: bytes) -> str:
    return zlib.decompress(compressed).decode()
