"""A disk that fails at a chosen operation while a test lasts: for SQLite, its default file system.

Operations are counted over all files: opening, writing, truncating, syncing and deleting, and the
synced writes of announcements. Reads and locks work.
"""

import errno
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from threading import RLock
from typing import Literal, TypeAlias
from unittest.mock import patch

import apsw

from service.storage.sqlite import announced_file

_BELOW = "unix"
Fault: TypeAlias = Literal["none", "fails", "full", "is short", "is slow", "dies", "loses power"]


@dataclass
class FaultyDisk:
    """Counts operations on the files in a folder, and does something to one of them."""

    folder: Path
    fault: Fault = "none"
    at: int = 0
    """Number of the operation, from 1."""
    lasts: int = 1
    """How many operations in a row."""
    slow_s: float = 0.2
    count: int = 0
    syncs: int = 0
    left: Path | None = None
    """The folder as whoever starts next finds it, after the process died."""
    _synced: dict[int, bytes] = field(default_factory=dict)
    """What is on the disk itself, by inode."""
    one_at_a_time: AbstractContextManager[object] = field(default_factory=RLock)
    """Power is lost before an operation or after it, also while two threads use the disk."""

    def does(self, write: Callable[[], object], short: Callable[[], object] | None = None) -> None:
        """Do one operation, or what the fault makes of it."""
        with self.one_at_a_time:
            self._do(write, short)

    def _do(self, write: Callable[[], object], short: Callable[[], object] | None) -> None:
        self.count += 1
        if self.left is not None:
            raise apsw.IOError("the process is dead")
        if not self.at <= self.count < self.at + self.lasts:
            write()
        elif self.fault == "fails":
            raise apsw.IOError("injected")
        elif self.fault == "full":
            raise apsw.FullError("injected")
        elif self.fault == "is slow":
            time.sleep(self.slow_s)
            write()
        elif self.fault == "is short":
            if short is not None:
                short()
            raise apsw.IOError("injected")
        elif self.fault in ("dies", "loses power"):
            if short is not None and self.fault == "dies":
                short()
            self._die()
        else:
            write()

    def synced(self, path: Path) -> None:
        """Note that a file is on the disk itself as it is now."""
        self.syncs += 1
        if self.fault == "loses power" and path.exists():
            self._synced[path.stat().st_ino] = path.read_bytes()

    def _die(self) -> None:
        self.left = self.folder.with_name(f"{self.folder.name}-left")
        shutil.copytree(self.folder, self.left, ignore=shutil.ignore_patterns("*-shm"))
        if self.fault == "loses power":
            for path in (*self.folder.rglob("*.db*"), *self.folder.glob("announced")):
                if not path.name.endswith("-shm"):
                    on_disk = self._synced.get(path.stat().st_ino, b"")
                    (self.left / path.relative_to(self.folder)).write_bytes(on_disk)
        raise apsw.IOError("the process died")


class _File(apsw.VFSFile):
    def __init__(
        self, disk: FaultyDisk, name: str | apsw.URIFilename | None, flags: list[int]
    ) -> None:
        super().__init__(_BELOW, name, flags)
        self._disk = disk
        self._path = Path(name.filename() if isinstance(name, apsw.URIFilename) else name or "")

    def xWrite(self, data: bytes, offset: int) -> None:  # noqa: N802
        below = super().xWrite
        half = bytes(data)[: len(data) // 2]
        self._disk.does(lambda: below(data, offset), lambda: half and below(half, offset))

    def xLock(self, level: int) -> None:  # noqa: N802
        try:
            super().xLock(level)
        except apsw.IOError:
            # A file that is open for reading cannot be locked for writing; SQLite does not mind,
            # and apsw would raise it all the same.
            raise apsw.BusyError("open for reading") from None

    def xTruncate(self, newsize: int) -> None:  # noqa: N802
        below = super().xTruncate
        self._disk.does(lambda: below(newsize))

    def xSync(self, flags: int) -> None:  # noqa: N802
        below = super().xSync
        with self._disk.one_at_a_time:
            self._disk.does(lambda: below(flags))
            self._disk.synced(self._path)


class _Files(apsw.VFS):
    def __init__(self, disk: FaultyDisk) -> None:
        super().__init__("faulty", _BELOW, makedefault=True)
        self._disk = disk

    def xOpen(self, name: str | apsw.URIFilename | None, flags: list[int]) -> _File:  # noqa: N802
        opened: list[_File] = []
        self._disk.does(lambda: opened.append(_File(self._disk, name, flags)))
        return opened[0]

    def xDelete(self, filename: str, syncdir: bool) -> None:  # noqa: N802
        below = super().xDelete
        self._disk.does(lambda: below(filename, syncdir))


def _write_all(disk: FaultyDisk, fd: int, content: bytes, offset: int) -> None:
    """Write to a file that is not SQLite's, and sync it."""
    half = content[: len(content) // 2]
    with disk.one_at_a_time:
        try:
            disk.does(lambda: os.pwrite(fd, content, offset), lambda: os.pwrite(fd, half, offset))
        except apsw.Error as error:
            raise OSError(errno.EIO, str(error)) from error
        disk.synced(Path(os.readlink(f"/proc/self/fd/{fd}")))


@contextmanager
def faulty(disk: FaultyDisk) -> Iterator[FaultyDisk]:
    """Let storage use a disk for all files that are opened meanwhile."""
    files = _Files(disk)
    try:
        with patch.object(announced_file, "write_synced", partial(_write_all, disk)):
            yield disk
    finally:
        files.unregister()
        apsw.set_default_vfs(_BELOW)
