"""Scripts and style sheets in fewer characters, where there is a library for that."""

import subprocess
import sys

import pytest

from api.http.page import minifier
from api.http.page.minifier import minified

SCRIPT = """\
export const $base$dom = (() => {
function el(tag) { return `<${tag}>`; }
return { el };
})();
"""
TEXTS = {"core-1.js": SCRIPT, "style-1.css": "a {\ncolor: red;\n}\n", "icon.svg": "<svg> </svg>"}


@pytest.mark.skipif(sys.platform != "linux", reason="there is no library")
def test_scripts_and_style_sheets_become_shorter_and_keep_the_names_that_others_use() -> None:
    shorter = minified(TEXTS)

    assert shorter["style-1.css"] == "a{color:red}"
    assert shorter["icon.svg"] == TEXTS["icon.svg"]
    script = shorter["core-1.js"]
    assert len(script) < len(SCRIPT)
    assert script.startswith("export const $base$dom=")
    assert "{el:" in script or "{el}" in script


def test_without_the_library_the_page_is_as_it_is_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(minifier, "_LIBRARY", "no_such_library")

    assert minified(TEXTS) == TEXTS


def test_a_library_that_fails_is_noted_and_the_page_is_served_all_the_same(
    caplog: pytest.LogCaptureFixture,
) -> None:
    broken = {**TEXTS, "core-1.js": "export const = ;"}

    assert minified(broken) == broken
    assert "the page is served as it is written" in caplog.text


def test_a_library_that_hangs_is_ended(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def hang(*_: object, **__: object) -> None:
        raise subprocess.TimeoutExpired("minify", 30)

    monkeypatch.setattr(subprocess, "run", hang)

    assert minified(TEXTS) == TEXTS
    assert "timed out" in caplog.text
