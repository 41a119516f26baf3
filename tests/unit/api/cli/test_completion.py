"""What is offered on a command line that is half typed."""

import os
from pathlib import Path

import pytest

from api.cli import completion
from api.cli.parser import make_parser, places


def offered(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return what follows on a line, as a shell gets it."""
    out = tmp_path / "offered"
    monkeypatch.setenv("_ARGCOMPLETE", "1")
    monkeypatch.setenv("_ARGCOMPLETE_STDOUT_FILENAME", str(out))
    monkeypatch.setenv("_ARGCOMPLETE_IFS", "\n")
    monkeypatch.setenv("COMP_LINE", line)
    monkeypatch.setenv("COMP_POINT", str(len(line)))
    # It ends with os._exit, which would end the tests as well.
    child = os.fork()
    if child == 0:
        completion.complete(make_parser(places()))
    assert os.waitpid(child, 0)[1] == 0
    return [word.strip() for word in out.read_text().splitlines()]


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("pilothouse re", {"release", "reactions", "replay"}),
        ("pilothouse state arm ", {"configure", "activate", "deactivate", "cleanup", "shutdown"}),
        ("pilothouse events --f", {"--follow", "--format"}),
        ("pilothouse completion ", {"bash", "zsh", "fish"}),
        ("pilothouse errors --format ", {"text", "json"}),
    ],
)
def test_words_come_from_the_parser_itself(
    line: str, words: set[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert set(offered(line, tmp_path, monkeypatch)) == words


def test_without_a_service_there_are_no_names_and_nothing_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PILOTHOUSE_URL", "http://127.0.0.1:1")

    assert offered("pilothouse mode ", tmp_path, monkeypatch) == []
    assert capfd.readouterr() == ("", "")
