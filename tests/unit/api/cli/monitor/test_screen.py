import io
import os
import pty
import sys
import termios
from collections.abc import Iterator
from typing import TextIO

import pytest
from rich.console import Console
from rich.text import Text

from api.cli.monitor.screen import Screen, alternate_screen


def terminal(width: int = 20, height: int = 3) -> Console:
    return Console(file=io.StringIO(), force_terminal=True, width=width, height=height)


def written(console: Console) -> str:
    """Return what was written since the last time."""
    assert isinstance(console.file, io.StringIO)
    text = console.file.getvalue()
    console.file.seek(0)
    console.file.truncate()
    return text


def lines(*texts: str) -> list[Text]:
    return [Text(text) for text in texts]


def test_the_first_picture_is_written_on_an_empty_screen() -> None:
    console = terminal()

    Screen(console).draw(lines("one", "two"))

    assert written(console) == "\x1b[2J\x1b[1;1Hone\x1b[K\x1b[2;1Htwo\x1b[K"


def test_of_the_next_picture_only_the_lines_that_changed_are_written() -> None:
    console = terminal()
    screen = Screen(console)
    screen.draw(lines("one", "two", "three"))
    written(console)

    screen.draw(lines("one", "2", "three"))

    assert written(console) == "\x1b[2;1H2\x1b[K"


def test_where_nothing_changed_nothing_is_written() -> None:
    console = terminal()
    screen = Screen(console)
    screen.draw(lines("one", "two"))
    written(console)

    screen.draw(lines("one", "two"))

    assert written(console) == ""


def test_a_line_that_is_gone_is_erased() -> None:
    console = terminal()
    screen = Screen(console)
    screen.draw(lines("one", "two"))
    written(console)

    screen.draw(lines("one"))

    assert written(console) == "\x1b[2;1H\x1b[K"


def test_behind_a_full_line_nothing_is_erased_since_that_would_take_its_last_character() -> None:
    console = terminal(width=3)

    Screen(console).draw(lines("one"))

    assert written(console) == "\x1b[2J\x1b[1;1Hone"


def test_lines_below_the_screen_are_not_written() -> None:
    console = terminal(height=2)

    Screen(console).draw(lines("one", "two", "three"))

    assert "three" not in written(console)


def test_on_a_screen_of_another_size_everything_is_drawn_anew() -> None:
    console = terminal()
    screen = Screen(console)
    screen.draw(lines("one"))
    written(console)

    console.size = console.size._replace(height=5)
    screen.draw(lines("one"))

    assert written(console) == "\x1b[2J\x1b[1;1Hone\x1b[K"


def test_what_is_forgotten_is_drawn_anew() -> None:
    console = terminal()
    screen = Screen(console)
    screen.draw(lines("one"))
    written(console)

    screen.forget()
    screen.draw(lines("one"))

    assert written(console) == "\x1b[2J\x1b[1;1Hone\x1b[K"


@pytest.fixture
def keyboard(monkeypatch: pytest.MonkeyPatch) -> Iterator[TextIO]:
    """A standard input that is a terminal."""
    controller, terminal_side = pty.openpty()
    with os.fdopen(terminal_side, "r") as opened:
        monkeypatch.setattr(sys, "stdin", opened)
        yield opened
    os.close(controller)


def echoes(keyboard: TextIO) -> bool:
    return bool(termios.tcgetattr(keyboard)[3] & termios.ECHO)


def test_the_terminal_is_left_as_it_was_however_the_end_comes(keyboard: TextIO) -> None:
    console = terminal()
    assert echoes(keyboard)

    def interrupted() -> None:
        with alternate_screen(console):
            assert not echoes(keyboard)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()

    assert echoes(keyboard)
    text = written(console)
    assert text.index("\x1b[?1049h") < text.index("\x1b[?1049l")
    assert text.index("\x1b[?25l") < text.index("\x1b[?25h")


def test_it_works_without_a_keyboard(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    console = terminal()

    with alternate_screen(console) as screen:
        screen.draw(lines("one"))

    assert "one" in written(console)
