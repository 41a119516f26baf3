"""Reads a text file that a person names, with clear reasons if it cannot be read."""

import codecs
from pathlib import Path

from domain.errors import PilothouseError

MAX_BYTES = 16 * 1024 * 1024


class UnreadableFileError(PilothouseError):
    """A file that does not exist, cannot be read, is too large, or is not text."""

    code = "UNREADABLE_FILE"

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"{path} cannot be read: {reason}")
        self.path = path


def read_bytes(path: Path) -> bytes:
    """Return the content of a file of at most `MAX_BYTES`.

    Raises:
        UnreadableFileError: There is no such file, or it is too large.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        # ValueError: a name with a null character in it.
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise UnreadableFileError(path, reason) from error
    if len(content) > MAX_BYTES:
        raise UnreadableFileError(path, f"it is larger than {MAX_BYTES // 1024 // 1024} MiB")
    return content


def read_text_file(path: Path) -> str:
    """Return the text of a UTF-8 file of at most `MAX_BYTES`.

    Raises:
        UnreadableFileError: There is no such file, it is too large, or it is not UTF-8.
    """
    content = read_bytes(path)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UnreadableFileError(path, f"it is not UTF-8 text (line {line})") from error


def decode_csv(raw: bytes) -> str:
    """Return a CSV as text: UTF-8, UTF-16 with a byte order mark, or else Latin-1.

    Numbers are the same in UTF-8 and Latin-1; names of columns may have a degree sign.
    """
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def lines_of(text: str) -> list[str]:
    """Return the lines of a file, which end with LF, CRLF or CR."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
