"""One service per folder: a lock that ends with the process, however that ends."""

import fcntl
import os
import weakref
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
        self._fd = os.open(path, os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, PRIVATE_FILE)
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
        try:
            os.ftruncate(self._fd, 0)
            os.pwrite(self._fd, f"{os.getpid()}\n".encode(), 0)
        except OSError:
            pass

    def release(self) -> None:
        """Give the lock back; may be called again."""
        if self._fd >= 0:
            os.close(self._fd)
            self._fd = -1


def _let_go_in_fork() -> None:
    # A forked process shares the lock, and would hold it after this one was killed.
    for lock in list(_held):
        lock.release()


os.register_at_fork(after_in_child=_let_go_in_fork)
