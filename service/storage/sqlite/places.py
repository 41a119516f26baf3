"""Where things are in the folder of a robot."""

import re
from dataclasses import dataclass
from pathlib import Path

PRIVATE_FOLDER = 0o700
"""Whoever runs the service may look into its folder, and nobody else."""
_LOG_NAME = re.compile(r"(\d{6,})\.db")


@dataclass(frozen=True, slots=True)
class Places:
    """Where things are in a folder."""

    folder: Path

    @property
    def lock(self) -> Path:
        """Return the file that the service holds a lock on."""
        return self.folder / "lock"

    @property
    def state(self) -> Path:
        """Return the file with what is kept at present."""
        return self.folder / "state.db"

    @property
    def announced(self) -> Path:
        """Return the file that says what was about to be done."""
        return self.folder / "announced"

    @property
    def logs(self) -> Path:
        """Return the folder of the log."""
        return self.folder / "log"

    def make(self) -> None:
        """Make the folders that are missing.

        Raises:
            OSError: They cannot be made.
        """
        for folder in (self.folder, self.logs):
            folder.mkdir(mode=PRIVATE_FOLDER, parents=True, exist_ok=True)

    def log(self, number: int) -> Path:
        """Return a file of the log."""
        return self.logs / f"{number:06}.db"

    def log_numbers(self) -> list[int]:
        """Return which files of the log there are, oldest first."""
        matches = (_LOG_NAME.fullmatch(path.name) for path in self.logs.iterdir())
        return sorted(int(match[1]) for match in matches if match)
