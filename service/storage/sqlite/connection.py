"""Connections to SQLite, all opened with the same care."""

import os
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path

import apsw

PRIVATE_FILE = 0o600
"""Whoever runs the service may read its files, and nobody else."""
_PATIENCE_MS = 1_000
"""How long another process may hold a file; only the writer's thread and readers' threads wait."""
SETTINGS = (
    # A failed read of a mapped file is a signal that ends the process.
    "PRAGMA mmap_size=0",
    "PRAGMA trusted_schema=OFF",
    "PRAGMA cell_size_check=ON",
    "PRAGMA temp_store=MEMORY",
)

SUFFIXES = ("", "-wal", "-shm")
"""A file, and those that SQLite keeps beside it."""
FAILURES = (apsw.Error, OSError)
"""What a disk makes fail."""


def library_version() -> str:
    """Return the version of SQLite."""
    return str(apsw.sqlite_lib_version())


def open_to_write(path: Path) -> apsw.Connection:
    """Open a file that this process alone writes; create it if it is missing.

    Raises:
        apsw.Error: It cannot be opened, or it is no database.
        OSError: It cannot be created.
    """
    if not path.exists():
        os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, PRIVATE_FILE))
    connection = apsw.Connection(str(path), flags=apsw.SQLITE_OPEN_READWRITE)
    try:
        connection.set_busy_timeout(_PATIENCE_MS)
        for setting in (*SETTINGS, "PRAGMA journal_mode=WAL", "PRAGMA synchronous=FULL"):
            connection.execute(setting)
        # A checkpoint is due after an answer, not before it: see `WriteAheadLog`.
        connection.execute("PRAGMA wal_autocheckpoint=0")
    except apsw.Error:
        connection.close(True)
        raise
    return connection


class WriteAheadLog:
    """Takes what was committed over a connection into its file, when that is worth it.

    SQLite would do so within a commit, for which somebody may wait.
    """

    def __init__(self, connection: apsw.Connection, worth_pages: int) -> None:
        """Begin with an empty one.

        Args:
            connection: From `open_to_write`.
            worth_pages: From how many pages on it is tidied.
        """
        self._connection = connection
        self._worth_pages = worth_pages
        self._pages = 0
        connection.set_wal_hook(self._on_commit)

    def tidy(self) -> None:
        """Take what is in it into the file, if that is worth it.

        Raises:
            apsw.Error: The file cannot be written.
        """
        if self._pages >= self._worth_pages:
            self._pages = 0
            self._connection.wal_checkpoint(mode=apsw.SQLITE_CHECKPOINT_PASSIVE)

    def _on_commit(self, connection: apsw.Connection, name: str, pages: int) -> int:
        self._pages = pages
        return apsw.SQLITE_OK


@contextmanager
def new_file(path: Path) -> Iterator[apsw.Connection]:
    """Yield the connection to a new file, which appears under its name when it is complete.

    Raises:
        apsw.Error: It cannot be written.
        OSError: It cannot be created.
    """
    growing = path.with_name(f"{path.name}.new")
    for left_over in (growing, growing.with_name(f"{growing.name}-journal")):
        left_over.unlink(missing_ok=True)
    os.close(os.open(growing, os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, PRIVATE_FILE))
    with closing(apsw.Connection(str(growing), flags=apsw.SQLITE_OPEN_READWRITE)) as connection:
        connection.execute("PRAGMA synchronous=FULL")
        with connection:
            yield connection
    growing.rename(path)
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Write names in a folder to the disk itself."""
    fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(fd)
    finally:
        os.close(fd)


@contextmanager
def reading(path: Path) -> Iterator[apsw.Connection]:
    """Yield a connection to a file that this process or another one may be writing.

    Raises:
        FileNotFoundError: There is no such file.
        apsw.Error: It cannot be read, or it is no database.
    """
    connection = _open_to_read(path)
    try:
        yield connection
    finally:
        connection.close(True)


def _open_to_read(path: Path) -> apsw.Connection:
    try:
        return _opened(path, apsw.SQLITE_OPEN_READONLY)
    except (apsw.ReadOnlyError, apsw.CantOpenError):
        if not path.exists():
            raise FileNotFoundError(path) from None
    # Its write-ahead log was left by a kill, and has to be gone through first.
    try:
        return _opened(path, apsw.SQLITE_OPEN_READWRITE)
    except (apsw.ReadOnlyError, apsw.CantOpenError):
        if path.with_name(f"{path.name}-wal").exists():
            raise
    # On a disk that nobody can write, nothing changes.
    return _opened(f"{path.resolve().as_uri()}?immutable=1", apsw.SQLITE_OPEN_READONLY)


def _opened(name: Path | str, flags: int) -> apsw.Connection:
    connection = apsw.Connection(str(name), flags=flags | apsw.SQLITE_OPEN_URI)
    try:
        connection.set_busy_timeout(_PATIENCE_MS)
        for setting in (*SETTINGS, "PRAGMA query_only=ON", "SELECT count(*) FROM sqlite_master"):
            connection.execute(setting).fetchall()
    except apsw.Error:
        connection.close(True)
        raise
    return connection


def finish(connection: apsw.Connection) -> None:
    """Close a file that this process wrote, as one plain file that needs no other to be read.

    If that fails, or another process reads it at this moment, it keeps its write-ahead log; nothing
    is lost.
    """
    with suppress(*FAILURES):
        connection.pragma("journal_mode", "delete")
    connection.close(True)


def remove(path: Path) -> None:
    """Delete a file of SQLite."""
    # The file first: without it, a log of it that is left cannot be taken for another one's.
    for suffix in SUFFIXES:
        path.with_name(f"{path.name}{suffix}").unlink(missing_ok=True)


def words(error: BaseException) -> str:
    """Return what failed, in words for an operator."""
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    if isinstance(error, apsw.Error):
        text = str(error)
        code = apsw.mapping_extended_result_codes.get(getattr(error, "extendedresult", 0))
        return f"{text} ({code})" if code else text
    return str(error) or type(error).__name__
