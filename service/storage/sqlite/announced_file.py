"""The file that says what was about to be done when a run ended.

It never grows and waits for no commit of the log, so a record costs one write that is synced. Two
places take turns: whatever tears the record that is written, the one before it can still be read.
"""

import errno
import os
import struct
import threading
import zlib
from pathlib import Path

from service.storage.sqlite.connection import PRIVATE_FILE, sync_folder

_FLAGS = os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_DSYNC
_PLACE_BYTES = 4_096
_PLACES = 2
_HEAD = struct.Struct("<QHI")
"""Number of the record, length of its text, checksum of both."""
ROOM_BYTES = _PLACE_BYTES - _HEAD.size
"""How long a text may be."""
_SPARE_BYTES = 64 * 4_096
"""Free space without which what follows from an announcement could not be stored."""


class AnnouncedFile:
    """One process writes it, in a thread that may wait for the disk.

    Args:
        path: Where it is.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._fd: int | None = None
        self._next = 1
        self._lock = threading.Lock()
        """It is opened anew in another thread than it is written in."""

    def renew(self) -> None:
        """Open it, or make it if somebody deleted it; also after a failure.

        Raises:
            OSError: It cannot be written.
        """
        with self._lock:
            self._close()
            self._next = max((number for number, _ in _records(self._path)), default=0) + 1
            fd = os.open(self._path, _FLAGS, PRIVATE_FILE)
            self._fd = fd
            if os.fstat(fd).st_size < _PLACES * _PLACE_BYTES:
                # Later writes take no space, and change nothing but what is in it.
                write_synced(fd, bytes(_PLACES * _PLACE_BYTES), 0)
                sync_folder(self._path.parent)
            self._require_use(fd)

    def write(self, text: bytes) -> None:
        """Write a text down in the place of the older of two; return when the disk has it.

        Args:
            text: At most `ROOM_BYTES`.

        Raises:
            OSError: It is not there, or there is no room for what follows from it.
        """
        with self._lock:
            if self._fd is None:
                raise BrokenPipeError("the file of what was asked is closed")
            self._require_use(self._fd)
            head = _HEAD.pack(self._next, len(text), _checksum(self._next, text))
            write_synced(self._fd, head + text, self._next % _PLACES * _PLACE_BYTES)
            self._next += 1

    def close(self) -> None:
        """Close it."""
        with self._lock:
            self._close()

    def _require_use(self, fd: int) -> None:
        if not os.fstat(fd).st_nlink:
            # Writing to a file that somebody deleted succeeds.
            raise FileNotFoundError(errno.ENOENT, "the folder was deleted")
        disk = os.fstatvfs(fd)
        # Some network file systems do not say how large they are.
        if disk.f_blocks and disk.f_bavail * disk.f_frsize < _SPARE_BYTES:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _close(self) -> None:
        if self._fd is not None:
            os.close(self._fd)
            self._fd = None


def last_text(path: Path) -> bytes | None:
    """Return what was written last; None: nothing, or it cannot be read."""
    return max(_records(path), default=(0, None))[1]


def _records(path: Path) -> list[tuple[int, bytes]]:
    """Return the records that are whole, each with its number."""
    try:
        content = path.read_bytes()
    except OSError:
        return []
    found = []
    for first in range(0, len(content) - _HEAD.size, _PLACE_BYTES):
        number, length, checksum = _HEAD.unpack_from(content, first)
        text = content[first + _HEAD.size :][:length]
        if number and checksum == _checksum(number, text):
            found.append((number, text))
    return found


def _checksum(number: int, text: bytes) -> int:
    return zlib.crc32(text, number & 0xFFFFFFFF)


def write_synced(fd: int, content: bytes, offset: int) -> None:
    """Write bytes to a file that was opened for synced writes: the disk has them afterwards."""
    if os.pwrite(fd, content, offset) < len(content):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
