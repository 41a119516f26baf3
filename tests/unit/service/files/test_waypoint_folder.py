import os
from pathlib import Path

import pytest

from domain.errors import InvalidValueError, PilothouseError, UnknownNameError
from service.files.text_file import MAX_BYTES, UnreadableFileError
from service.files.waypoint_folder import WaypointFolder

LINE = b"0,0,0\n9,0,0\n"


@pytest.fixture
def folder(tmp_path: Path) -> WaypointFolder:
    """A folder with a file in it, and a secret beside it."""
    path = tmp_path / "tracks"
    path.mkdir()
    (path / "loop.csv").write_bytes(LINE)
    (tmp_path / "secret.csv").write_bytes(b"1,1,1\n")
    return WaypointFolder(path)


@pytest.mark.parametrize("name", ["loop.csv", "Hof 2 (süd).csv", "a" * 251 + ".csv"])
def test_a_file_is_read_by_its_name(folder: WaypointFolder, name: str) -> None:
    (folder.path / name).write_bytes(LINE)

    assert folder.read(name) == LINE


@pytest.mark.parametrize(
    "name",
    [
        "",
        ".",
        "..",
        "../secret.csv",
        "..\\secret.csv",
        "./loop.csv",
        "/etc/passwd",
        "sub/loop.csv",
        ".hidden.csv",
        "~/loop.csv",
        "loop.csv\0",
        "loop.csv\n",
        "C:loop.csv",
        "%2e%2e/secret.csv",
        "a" * 256,
        "ü" * 200,
        "\udcff",
    ],
)
def test_what_is_no_bare_name_is_rejected(folder: WaypointFolder, name: str) -> None:
    with pytest.raises(InvalidValueError) as caught:
        folder.read(name)

    assert caught.value.pointer == "file"


@pytest.mark.parametrize("name", ["secret.csv", "Loop.csv", "passwd", "%2e%2e%2fsecret.csv"])
def test_a_file_that_is_not_there_is_told_with_those_that_are(
    folder: WaypointFolder, name: str
) -> None:
    with pytest.raises(UnknownNameError, match="there is no waypoint file") as caught:
        folder.read(name)

    assert caught.value.hint is not None
    assert "loop.csv" in caught.value.hint


def test_a_link_out_of_the_folder_is_not_followed(folder: WaypointFolder) -> None:
    (folder.path / "out.csv").symlink_to(folder.path.parent / "secret.csv")
    (folder.path / "up.csv").symlink_to("..")
    (folder.path / "self.csv").symlink_to("self.csv")

    for name in ("out.csv", "up.csv", "self.csv"):
        with pytest.raises(UnknownNameError) as caught:
            folder.read(name)
        assert caught.value.hint == "known: loop.csv"


def test_a_link_within_the_folder_is_followed(folder: WaypointFolder) -> None:
    # So Kubernetes mounts files of a ConfigMap.
    (folder.path / "..data").mkdir()
    (folder.path / "..data" / "yard.csv").write_bytes(LINE)
    (folder.path / "yard.csv").symlink_to("..data/yard.csv")

    assert folder.read("yard.csv") == LINE


def test_a_pipe_or_a_folder_is_no_file(folder: WaypointFolder) -> None:
    os.mkfifo(folder.path / "pipe.csv")
    (folder.path / "deep").mkdir()

    for name in ("pipe.csv", "deep"):
        with pytest.raises(UnknownNameError):
            folder.read(name)


def test_a_file_that_is_too_large_is_rejected(folder: WaypointFolder) -> None:
    with (folder.path / "huge.csv").open("wb") as file:
        file.truncate(MAX_BYTES + 1)

    with pytest.raises(UnreadableFileError, match="larger than 16 MiB"):
        folder.read("huge.csv")


def test_without_the_folder_there_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(PilothouseError, match="there is no waypoint file"):
        WaypointFolder(tmp_path / "gone").read("a.csv")
