from pathlib import Path

from service.storage.errors import FolderInUseError, ForeignFolderError


def test_whoever_is_in_the_way_is_named() -> None:
    assert str(FolderInUseError(Path("/data"), "4711")) == (
        "/data is in use by process 4711; two services cannot share a folder"
    )
    assert "by another process;" in str(FolderInUseError(Path("/data"), ""))


def test_both_robots_are_named() -> None:
    assert str(ForeignFolderError(Path("/data"), "gem", "polaris")) == (
        "/data belongs to the robot 'gem', and this one is 'polaris'; nothing in it was changed"
    )
