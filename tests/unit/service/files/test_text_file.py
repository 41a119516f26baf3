from pathlib import Path

import pytest

from service.files.text_file import MAX_BYTES, UnreadableFileError, read_text_file


def test_a_text_is_read_without_the_mark_that_some_editors_put_before_it(tmp_path: Path) -> None:
    path = tmp_path / "model.yaml"
    path.write_bytes("\ufeffgröße: 1\n".encode())

    assert read_text_file(path) == "größe: 1\n"


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        pytest.param(b"a: 1\nb: \xff\n", r"it is not UTF-8 text \(line 2\)", id="not UTF-8"),
        pytest.param(b"#" * (MAX_BYTES + 1), "it is larger than 16 MiB", id="too large"),
    ],
)
def test_a_file_that_is_no_text_is_refused(tmp_path: Path, content: bytes, reason: str) -> None:
    path = tmp_path / "model.yaml"
    path.write_bytes(content)

    with pytest.raises(UnreadableFileError, match=reason):
        read_text_file(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(UnreadableFileError, match=r"gone\.yaml cannot be read: No such file"):
        read_text_file(tmp_path / "gone.yaml")


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(UnreadableFileError, match="Is a directory"):
        read_text_file(tmp_path)


def test_an_impossible_name_is_refused() -> None:
    with pytest.raises(UnreadableFileError, match="null"):
        read_text_file(Path("a\x00b"))
