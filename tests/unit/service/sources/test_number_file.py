import os
from collections.abc import Callable
from pathlib import Path

import pytest

from service.files.source_block import FileBlock
from service.sources.number_file import NumberFile, file_source
from service.sources.source import SourceError
from tests.support.manual_clock import ManualClock


def read(path: object, **settings: float) -> float:
    return NumberFile(FileBlock.model_validate({"path": str(path), **settings})).read()


def test_a_number_is_scaled_and_then_moved(tmp_path: Path) -> None:
    file = tmp_path / "temp1_input"
    file.write_text("42500\n")

    assert read(file) == 42_500
    assert read(file, scale=0.001, offset=-0.5) == 42.0


@pytest.mark.parametrize("text", ["", "hot\n", "1 2\n", "0x10", "9" * 65, "\xff"])
def test_what_is_not_one_number_is_refused(tmp_path: Path, text: str) -> None:
    file = tmp_path / "value"
    file.write_text(text, encoding="latin-1")

    with pytest.raises(SourceError, match="not a number"):
        read(file)


def test_only_the_beginning_of_a_large_file_is_read(tmp_path: Path) -> None:
    file = tmp_path / "huge"
    with file.open("wb") as opened:
        opened.truncate(1 << 40)

    with pytest.raises(SourceError):
        read(file)


def test_a_pipe_without_a_writer_is_not_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)

    with pytest.raises(SourceError):
        read(pipe)


@pytest.mark.parametrize("make", [lambda _: None, Path.mkdir])
def test_a_file_that_cannot_be_read_says_why(
    tmp_path: Path, make: Callable[[Path], object]
) -> None:
    make(tmp_path / "value")

    with pytest.raises(OSError, match=r"No such file|Is a directory"):
        read(tmp_path / "value")


def test_an_asterisk_stands_for_what_changes_from_start_to_start(tmp_path: Path) -> None:
    (tmp_path / "hwmon3").mkdir()
    (tmp_path / "hwmon3" / "temp1_input").write_text("1")
    assert read(tmp_path / "hwmon*" / "temp1_input") == 1

    (tmp_path / "hwmon4").mkdir()
    (tmp_path / "hwmon4" / "temp1_input").write_text("2")
    with pytest.raises(SourceError, match="2 files match"):
        read(tmp_path / "hwmon*" / "temp1_input")


def test_a_file_may_be_read_for_several_signals(tmp_path: Path) -> None:
    block = FileBlock(path=str(tmp_path / "value"))

    assert file_source(ManualClock(), block.path, {"a": block, "b": block}).signals == ("a", "b")
