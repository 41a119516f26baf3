"""The page of an image, which has no minifier."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from api.http.page import ahead, assembled_page, make_ahead


@pytest.fixture(autouse=True)
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """In a folder of its own: a page that was made ahead would be served by every later test."""
    file = tmp_path / "minified.json"
    monkeypatch.setattr(ahead, "beside", lambda: file)
    assembled_page.assembled_page.cache_clear()
    yield file
    assembled_page.assembled_page.cache_clear()


def unavailable(_: Mapping[str, str]) -> Mapping[str, str]:
    raise AssertionError("it is minified once more")


def halved(texts: Mapping[str, str]) -> Mapping[str, str]:
    return {name: text[: len(text) // 2] for name, text in texts.items()}


def test_a_page_that_was_made_ahead_needs_no_library(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(make_ahead, "minified", halved)
    assert make_ahead.main() == 0
    assert file.exists()
    monkeypatch.setattr(assembled_page, "minified", unavailable)

    sizes = {
        name: len(item.content) for name, item in assembled_page.assembled_page().files.items()
    }
    monkeypatch.setattr(assembled_page, "kept", lambda _: None)
    monkeypatch.setattr(assembled_page, "minified", lambda texts: texts)
    assembled_page.assembled_page.cache_clear()
    written = assembled_page.assembled_page().files
    assert all(sizes[name] < len(item.content) for name, item in written.items())


def test_without_the_library_nothing_is_made_ahead(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(make_ahead, "minified", dict)

    with pytest.raises(SystemExit, match="was not minified"):
        make_ahead.main()
    assert not file.exists()
