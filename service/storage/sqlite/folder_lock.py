"""One service per folder: a lock that ends with the process, however that ends."""

import errno
import fcntl
import os
import weakref
from contextlib import suppress
from pathlib import Path

from service.storage.errors import FolderInUseError
from service.storage.sqlite.connection import PRIVATE_FILE

_MAX_PID_BYTES = 32
_held: "weakref.WeakSet[FolderLock]" = weakref.WeakSet()


class FolderLock:
    """Holds the lock of a folder.

    A file that a killed process left is no obstacle: the lock is the kernel's, and the file is only
    its name.
    """

    def __init__(self, path: Path) -> None:
        """Take the lock.

        Raises:
            FolderInUseError: Another process has it.
            OSError: The file cannot be opened.
        """
        self._fd = _open(path)
        try:
            fcntl.flock(self._fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            holder = os.pread(self._fd, _MAX_PID_BYTES, 0).decode("ascii", "replace").strip()
            os.close(self._fd)
            raise FolderInUseError(path.parent, holder) from None
        except OSError:
            os.close(self._fd)
            raise
        _held.add(self)
        # For whoever is told that the folder is in use; the lock does not depend on it.
        with suppress(OSError):
            os.ftruncate(self._fd, 0)
            os.pwrite(self._fd, f"{os.getpid()}\n".encode(), 0)

    def release(self) -> None:
        """Give the lock back; may be called again."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1


def _open(path: Path) -> int:
    try:
        return os.open(path, os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, PRIVATE_FILE)
    except OSError as error:
        if error.errno != errno.EROFS:
            raise
    # A lock needs no file that can be written.
    return os.open(path, os.O_RDONLY | os.O_CLOEXEC)


def _let_go_in_fork() -> None:
    # A forked process shares the lock, and would hold it after this one was killed.
    for lock in list(_held):
        lock.release()


os.register_at_fork(after_in_child=_let_go_in_fork)
