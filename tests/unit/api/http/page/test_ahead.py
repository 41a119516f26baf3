"""A page that was minified before the first start."""

from pathlib import Path

import pytest

from api.http.page.ahead import keep, kept

TEXTS = {"core-1.js": "const a = 1;\n", "style-1.css": "a { color: red }\n"}
MADE = {"core-1.js": "const a=1", "style-1.css": "a{color:red}"}


def test_what_was_made_ahead_is_served(tmp_path: Path) -> None:
    file = keep(TEXTS, MADE, tmp_path / "kept.json")

    assert kept(TEXTS, file) == MADE


def test_what_was_made_of_another_page_is_not_served(tmp_path: Path) -> None:
    file = keep(TEXTS, MADE, tmp_path / "kept.json")

    assert kept({**TEXTS, "core-1.js": "const a = 2;\n"}, file) is None


def test_usually_nothing_was_made_ahead(tmp_path: Path) -> None:
    assert kept(TEXTS, tmp_path / "missing.json") is None
    assert kept(TEXTS) is None


@pytest.mark.parametrize("content", [b"{", b"[]", b'{"of": 1}', b"\xff"])
def test_a_damaged_file_is_told_and_the_page_is_made_again(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, content: bytes
) -> None:
    file = tmp_path / "kept.json"
    file.write_bytes(content)

    assert kept(TEXTS, file) is None
    assert "cannot be read" in caplog.text
