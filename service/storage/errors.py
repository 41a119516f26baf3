"""Why a folder cannot be used; the service does not start then.

What fails later never ends the service: see `StorageDegradedError`.
"""

from pathlib import Path


class UnusableFolderError(Exception):
    """The folder of data cannot be used."""


class FolderInUseError(UnusableFolderError):
    """Another process works with the folder."""

    def __init__(self, folder: Path, pid: str) -> None:
        who = f"process {pid}" if pid.isdigit() else "another process"
        super().__init__(f"{folder} is in use by {who}; two services cannot share a folder")


class ForeignFolderError(UnusableFolderError):
    """The folder belongs to another robot."""

    def __init__(self, folder: Path, owner: str, robot: str) -> None:
        super().__init__(
            f"{folder} belongs to the robot {owner!r}, and this one is {robot!r};"
            " nothing in it was changed"
        )
