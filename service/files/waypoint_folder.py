"""The folder of waypoint files that clients may name, each by its bare name."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from domain.errors import InvalidValueError, UnknownNameError
from service.files.text_file import read_bytes

MAX_CHARACTERS = 255
"""Of a name, as file systems have it."""
_MOST_LISTED = 1_000


@dataclass(frozen=True, slots=True)
class WaypointFolder:
    """A folder; nothing beyond it is ever read, whatever a client names."""

    path: Path

    def read(self, name: str) -> bytes:
        """Return the content of a file.

        Args:
            name: As a client sent it: of a file directly in the folder, and never a path. A link is
                followed as long as it stays below the folder.

        Raises:
            InvalidValueError: It cannot be the name of a file.
            UnknownNameError: There is no such file; the hint lists some that there are.
            UnreadableFileError: It cannot be read, or is too large.
        """
        check_name(name)
        file = self.path / name
        if not self._is_inside(file):
            raise UnknownNameError("waypoint file", name, self._names())
        return read_bytes(file)

    def _is_inside(self, file: Path) -> bool:
        """Tell whether something is a file of this folder, and no device, pipe or way out."""
        try:
            return file.is_file() and file.resolve().is_relative_to(self.path.resolve())
        except (OSError, RuntimeError):
            # RuntimeError: links that lead in a circle.
            return False

    def _names(self) -> Sequence[str]:
        try:
            with os.scandir(self.path) as entries:
                found = [entry.name for entry in islice(entries, _MOST_LISTED)]
        except OSError:
            return ()
        return sorted(n for n in found if not n.startswith(".") and self._is_inside(self.path / n))


def check_name(name: str) -> None:
    """Reject what is no bare name of a visible file, without asking the file system.

    Raises:
        InvalidValueError: It is empty or too long, or has a separator or a control character in it.
    """
    if not name:
        raise InvalidValueError("the name of a waypoint file is missing", "file")
    is_plain = name.isprintable() and not name.startswith(".") and not set(name) & set("/\\:")
    if not is_plain or len(name.encode(errors="replace")) > MAX_CHARACTERS:
        message = (
            f"file must be the name of a file in the folder for waypoint files, not {name!r:.80}"
        )
        raise InvalidValueError(message, "file")
