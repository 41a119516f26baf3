"""What an earlier run left in a folder, found at the start; nothing is moved or changed yet."""

import shutil
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

import apsw

from service.storage.errors import ForeignFolderError
from service.storage.id_blocks import BLOCKS, BOOT, EVENT, UNKNOWN_TAIL, IdKind
from service.storage.sqlite.announced_file import last_text
from service.storage.sqlite.batch import IDS, Changes, Key
from service.storage.sqlite.connection import reading, words
from service.storage.sqlite.log_file import LogFile, Next
from service.storage.sqlite.log_summary import LogSummary, summary_of
from service.storage.sqlite.places import Places
from service.storage.sqlite.schema import LOG, BrokenFileError, NewerFileError, version_of
from service.storage.sqlite.state_file import StateFile

_BROKEN = (
    *(apsw.CorruptError, apsw.NotADBError, apsw.SQLError, apsw.MismatchError),
    *(BrokenFileError, NewerFileError, KeyError, TypeError, ValueError),
)
_BAD_READS = (
    *(apsw.SQLITE_IOERR_READ, apsw.SQLITE_IOERR_SHORT_READ, apsw.SQLITE_IOERR_CORRUPTFS),
    apsw.SQLITE_IOERR_DATA,
)

FileType = TypeVar("FileType", LogFile, StateFile)


@dataclass(slots=True)
class Left:
    """What an earlier run left."""

    kept: dict[Key, bytes] = field(default_factory=dict)
    state: StateFile | None = None
    lag: Changes = field(default_factory=dict)
    """What the state lacks of `kept`."""
    log: LogFile | None = None
    """The file that the log goes on in; None: a new one."""
    last_number: int = 0
    """Number of the newest file of the log, whatever is in it."""
    closed: list[LogSummary] = field(default_factory=list)
    """Files of the log before it, oldest first."""
    announced: bytes | None = None
    """What was about to be done, as JSON; None: nothing was."""
    broken: dict[Path, str] = field(default_factory=dict)
    """Files to move aside, and why."""

    @property
    def is_new(self) -> bool:
        """Tell whether no run left anything."""
        return not (self.kept or self.state or self.log or self.closed or self.broken)

    @property
    def newest(self) -> LogSummary | None:
        """Return the summary of the newest file of the log that can be read."""
        if self.log is not None:
            return self.log.summary
        return self.closed[-1] if self.closed else None

    @property
    def files(self) -> list[LogSummary]:
        """Return the summaries of all files of the log that can be read, oldest first."""
        return [*self.closed, *([self.log.summary] if self.log is not None else [])]

    def next_ids(self) -> dict[IdKind, int]:
        """Return the first id of each kind that no run can have used."""
        ids = {kind: self._kept_id(kind) for kind in (*BLOCKS, BOOT)}
        if self.newest is not None:
            ids[EVENT] = max(ids[EVENT], self.newest.last_event + 1)
            ids[BOOT] = max(ids[BOOT], self.newest.last_boot + 1)
        if self.broken:
            # What was reserved last may be in a file that cannot be read.
            for kind, block in BLOCKS.items():
                ids[kind] += UNKNOWN_TAIL * block
        return ids

    def next_numbers(self, event: int) -> Next:
        """Return where steps and batches go on; events do with `event`."""
        newest = self.newest
        if newest is None:
            return Next(event=event)
        return Next(newest.next_step, newest.last_batch + 1, event)

    def close(self) -> None:
        """Close the files."""
        for file in (self.state, self.log):
            if file is not None:
                file.close()

    def _kept_id(self, kind: IdKind) -> int:
        value = self.kept.get((IDS, kind))
        return 1 if value is None else int(value)


def is_fault_of_file(error: Exception) -> bool:
    """Tell whether a file is broken, rather than the disk full, read-only or gone."""
    return isinstance(error, _BROKEN) or getattr(error, "extendedresult", None) in _BAD_READS


def look(places: Places, robot: str) -> Left:
    """Open what is in a folder, and bring it up to the end of the log.

    Args:
        places: The folder, which this process has locked.
        robot: Name of the robot.

    Raises:
        ForeignFolderError: It belongs to another robot; nothing in it was changed.
        apsw.Error: The disk fails.
    """
    numbers = places.log_numbers()
    for path in (places.state, *(places.log(number) for number in reversed(numbers))):
        owner = _owner(path)
        if owner is not None and owner != robot:
            raise ForeignFolderError(places.folder, owner, robot)
    left = Left(last_number=numbers[-1] if numbers else 0, announced=last_text(places.announced))
    try:
        _open_files(left, places, numbers)
        _gather(left)
    except BaseException:
        left.close()
        raise
    return left


def look_at_copy(places: Places, robot: str) -> Left:
    """Return what is in a folder on a disk that cannot be written, without its files.

    Raises:
        apsw.Error: It cannot be read either.
        OSError: Likewise.
    """
    numbers = places.log_numbers()
    with TemporaryDirectory() as folder:
        copy = Places(Path(folder))
        copy.logs.mkdir()
        if places.announced.exists():
            shutil.copyfile(places.announced, copy.announced)
        for path in (places.state, *(places.log(number) for number in numbers[-1:])):
            for file in path.parent.glob(f"{path.name}*"):
                if file.name in (path.name, f"{path.name}-wal"):
                    shutil.copyfile(file, copy.folder / file.relative_to(places.folder))
        left = look(copy, robot)
        if left.log is not None:
            left.closed = [left.log.summary]
        left.close()
        left.state = left.log = None
    return left


def _owner(path: Path) -> str | None:
    """Return the robot that a file belongs to, without a lock or a trace; None: unknown."""
    try:
        uri = f"{path.resolve().as_uri()}?immutable=1"
        flags = apsw.SQLITE_OPEN_READONLY | apsw.SQLITE_OPEN_URI
        with closing(apsw.Connection(uri, flags=flags)) as connection:
            found = connection.execute("SELECT value FROM meta WHERE name = 'robot'").get
    except apsw.Error:
        return None
    return found if isinstance(found, str) else None


def _open_files(left: Left, places: Places, numbers: list[int]) -> None:
    if places.state.exists():
        left.state = _opened(left, places.state, StateFile.open)
    for number in numbers:
        path = places.log(number)
        if number == left.last_number:
            left.log = _opened(left, path, lambda path: LogFile.open(path, left.last_number))
        else:
            summary = _summary(left, path, number)
            if summary is not None:
                left.closed.append(summary)


def _opened(left: Left, path: Path, open_file: Callable[[Path], FileType]) -> FileType | None:
    try:
        return open_file(path)
    except Exception as error:
        if not is_fault_of_file(error):
            raise
        left.broken[path] = words(error)
        return None


def _summary(left: Left, path: Path, number: int) -> LogSummary | None:
    """Return what an older file of the log holds, which is finished if a kill left it open."""
    try:
        with reading(path) as connection:
            is_older = version_of(connection) != len(LOG)
        if is_older or path.with_name(f"{path.name}-wal").exists():
            LogFile.open(path, number).finish()
        with reading(path) as connection:
            summary = summary_of(connection, path, number)
            return replace(summary, file_bytes=path.stat().st_size)
    except Exception as error:
        if not is_fault_of_file(error):
            raise
        left.broken[path] = words(error)
        return None


def _gather(left: Left) -> None:
    """Bring together what is kept."""
    log, state = left.log, left.state
    if log is None:
        left.kept = {} if state is None else state.kept()
        return
    after = 0
    if state is not None:
        applied = state.applied()
        if applied.log == log.number and applied.change <= log.last_change:
            left.kept, after = state.kept(), applied.change
        else:
            # It is of another log than this one, and is made anew.
            state.close()
            left.state = None
    left.lag = {(kind, name): value for kind, name, value in log.changes_after(after)}
    for key, value in left.lag.items():
        if value is None:
            left.kept.pop(key, None)
        else:
            left.kept[key] = value
