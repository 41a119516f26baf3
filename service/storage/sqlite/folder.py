"""The folder of a robot: its files, and when each is begun, finished and dropped.

All of this runs in the writer's thread. The log's commit is the commit point; the state follows.
"""

import errno
import shutil
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from domain.timebase import Duration, seconds
from service.storage.sqlite.batch import Changes, Flight, Key
from service.storage.sqlite.connection import FAILURES, SUFFIXES, remove, sync_folder, words
from service.storage.sqlite.log_file import LogFile, Next, Run
from service.storage.sqlite.log_summary import LogSummary
from service.storage.sqlite.looking import Left, is_fault_of_file, look
from service.storage.sqlite.places import Places
from service.storage.sqlite.state_file import Applied, StateFile


@dataclass(frozen=True, slots=True)
class Retention:
    """How much of the log is kept; whole files are dropped, the oldest first."""

    file_bytes: int = 64 * 2**20
    """Size at which the next file is begun."""
    file_running: Duration = seconds(24 * 3600.0)
    """Recorded running time after which the next file is begun."""
    total_bytes: int = 2 * 2**30
    total_running: Duration = seconds(30 * 24 * 3600.0)
    """Recorded running time that is kept at least, unless that is more than `total_bytes`. It is
    not time of day: a step of the system clock drops nothing."""


DEFAULT_RETENTION = Retention()


@dataclass(frozen=True, slots=True)
class Report:
    """How the folder is, for the loop."""

    files: tuple[LogSummary, ...]
    """Of the log, oldest first."""
    bytes: int
    free_bytes: int | None
    state_fault: str | None
    """Why `state.db` cannot be written; the log has what it lacks."""
    began_file: bool
    """Whether the log went on in a new file since the last report."""


@dataclass(frozen=True, slots=True)
class Start:
    """How a run begins."""

    run: Run
    changes: Changes
    """What it changes of what is kept, before anything else."""
    next: Next
    """Its first numbers."""


class Folder:
    """The files while the service runs."""

    def __init__(self, places: Places, robot: str, retention: Retention, start: Start) -> None:
        self._places = places
        self._robot = robot
        self._retention = retention
        self._start = start
        self._run = start.run
        self._next = start.next
        self._has_started = False
        self._log: LogFile | None = None
        self._state: StateFile | None = None
        self._state_fault: str | None = None
        self._kept: dict[Key, bytes] = {}
        self._lag: Changes = {}
        """What the state lacks of `_kept`."""
        self._closed: list[LogSummary] = []
        self._last_number = 0
        self._began_file = False

    def start(self, left: Left) -> None:
        """Begin the run: first what it keeps is in the log, then broken files are moved aside.

        Args:
            left: What the earlier run left; its files become this object's.

        Raises:
            apsw.Error: It cannot be written.
            OSError: Likewise.
        """
        self._log, self._state = left.log, left.state
        self._closed, self._last_number = left.closed, left.last_number
        self._kept, self._lag = left.kept, left.lag
        changes = self._start.changes
        if self._log is not None and self._log.summary.last_batch >= self._next.batch:
            # It could not be read when the numbers of this run were chosen.
            self._closed.append(self._log.summary)
            self._log.close()
            self._log = None
        if self._log is None:
            self._update(changes)
            self._log = self._new_log()
        else:
            self._log.begin_run(self._run, changes, self._next)
            self._update(changes)
        for path in left.broken:
            _move_aside(path)
        self._follow()
        self._has_started = True

    def write(self, flight: Flight) -> None:
        """Write batches down.

        Raises:
            apsw.Error: Nothing was written, or nobody knows; then only `recover` goes on.
            OSError: Likewise.
        """
        log = self._require_log()
        if not log.path.exists():
            # Writing to a file that somebody deleted succeeds.
            raise FileNotFoundError(errno.ENOENT, "the log was deleted")
        changes = _changes_of(flight)
        log.write(flight, self._run, changes)
        self._count(log)
        self._update(changes)

    def follow(self) -> Report:
        """Do what no answer waits for, after some `write`; what fails is told and tried again.

        Raises:
            apsw.Error: The log cannot be written any more; then only `recover` goes on.
            OSError: Likewise.
        """
        self._follow()
        log = self._require_log()
        log.tidy()
        self._rotate(log)
        self._drop_old(self._require_log())
        return self.report()

    def recover(self, flight: Flight) -> None:
        """Open the log anew after a failure, and write all that waits and all that is kept.

        Raises:
            apsw.Error: Storage still fails.
            OSError: Likewise.
        """
        self._let_go()
        if not self._has_started:
            self.start(look(self._places, self._robot))
        else:
            self._log = self._reopened()
        log = self._require_log()
        changes = _changes_of(flight)
        everything: Changes = {**self._kept, **changes}
        log.write(replace(flight, must_last=True), self._run, everything)
        self._count(log)
        self._update(changes)
        self._follow()

    def report(self) -> Report:
        """Return how the folder is."""
        began_file, self._began_file = self._began_file, False
        if self._log is None:
            return Report((), 0, None, None, began_file)
        return Report(
            (*self._closed, self._log.summary),
            self._size(self._log),
            shutil.disk_usage(self._places.folder).free,
            self._state_fault,
            began_file,
        )

    def close(self) -> None:
        """Close the files as plain ones."""
        for file in (self._log, self._state):
            if file is not None:
                file.finish()
        self._log = self._state = None

    def _require_log(self) -> LogFile:
        if self._log is None:
            raise BrokenPipeError("the log is closed")
        return self._log

    def _count(self, log: LogFile) -> None:
        """Note where steps, batches and events go on."""
        done = log.summary
        self._next = Next(
            done.next_step, done.last_batch + 1, max(self._next.event, done.last_event + 1)
        )

    def _update(self, changes: Mapping[Key, bytes | None]) -> None:
        self._lag.update(changes)
        for key, value in changes.items():
            if value is None:
                self._kept.pop(key, None)
            else:
                self._kept[key] = value

    def _follow(self) -> None:
        """Bring the state up to the log; a state that cannot be written is made anew."""
        log = self._require_log()
        lag, self._lag = self._lag, {}
        if not lag and self._state is not None:
            return
        applied = Applied(log.number, log.last_change)
        try:
            if self._state is None:
                self._state = self._new_state(applied)
            else:
                self._state.apply(lag, applied)
            self._state_fault = None
        except FAILURES as error:
            self._state_fault = f"state.db: {words(error)}"
            self._drop_state()

    def _new_state(self, applied: Applied) -> StateFile:
        path = self._places.state
        remove(path)
        return StateFile.begin(path, self._robot, self._kept, applied)

    def _drop_state(self) -> None:
        state, self._state = self._state, None
        if state is not None:
            with suppress(*FAILURES):
                state.close()

    def _let_go(self) -> None:
        log, self._log = self._log, None
        self._drop_state()
        if log is not None:
            with suppress(*FAILURES):
                log.close()

    def _reopened(self) -> LogFile:
        path = self._places.log(self._last_number)
        # Somebody may have deleted the folder.
        self._places.make()
        try:
            log = LogFile.open(path, self._last_number)
        except Exception as error:
            if path.exists() and not is_fault_of_file(error):
                raise
            log = self._new_log()
            if path.exists():
                _move_aside(path)
            return log
        log.begin_run(self._run, {}, self._next)
        return log

    def _new_log(self, dictionary: bytes = b"") -> LogFile:
        number = self._last_number + 1
        log = LogFile.begin(
            self._places.log(number),
            number,
            self._robot,
            self._run,
            self._kept,
            self._next,
            dictionary,
        )
        self._last_number, self._began_file = number, True
        return log

    def _rotate(self, log: LogFile) -> None:
        keep = self._retention
        # What is kept may be large by itself; it is in each file.
        grown = log.size() - log.first_size
        if grown < keep.file_bytes and log.summary.running_ns < keep.file_running:
            return
        self._log = self._new_log(log.dictionary)
        log.finish()
        self._closed.append(replace(log.summary, file_bytes=log.path.stat().st_size))
        self._follow()

    def _drop_old(self, log: LogFile) -> None:
        while self._closed and self._is_too_much(log):
            remove(self._closed.pop(0).path)

    def _is_too_much(self, log: LogFile) -> bool:
        keep = self._retention
        running = log.summary.running_ns + sum(file.running_ns for file in self._closed[1:])
        size = log.size() + sum(file.file_bytes for file in self._closed)
        return running >= keep.total_running or size > keep.total_bytes

    def _size(self, log: LogFile) -> int:
        places = self._places
        state = places.state.stat().st_size if places.state.exists() else 0
        return state + log.size() + sum(file.file_bytes for file in self._closed)


def _changes_of(flight: Flight) -> Changes:
    changes: Changes = {}
    for batch in flight.batches:
        changes.update(batch.changes)
    return changes


def _move_aside(path: Path) -> None:
    """Keep a broken file under a name that says when it was found."""
    stamp = datetime.now(UTC).strftime("%Y%m%dT%H%M%S.%fZ")
    for suffix in SUFFIXES:
        part = path.with_name(f"{path.name}{suffix}")
        if part.exists():
            part.rename(path.with_name(f"{path.name}.broken-{stamp}{suffix}"))
    sync_folder(path.parent)
