import io

import pytest

from api.cli.terminal_line import TerminalLine


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "10")


def test_each_text_is_written_in_place_of_the_one_before() -> None:
    out = Terminal()
    line = TerminalLine(out, period_s=0)

    line.show("one")
    line.show("two")

    assert out.getvalue() == "\r\x1b[2Kone\r\x1b[2Ktwo"


def test_nothing_is_written_where_there_is_no_terminal() -> None:
    out = io.StringIO()

    with TerminalLine(out) as line:
        line.show("one")

    assert not line.is_shown
    assert out.getvalue() == ""


@pytest.mark.usefixtures("narrow")
def test_a_text_never_reaches_the_last_column() -> None:
    out = Terminal()

    TerminalLine(out).show("0123456789abc")

    assert out.getvalue() == "\r\x1b[2K012345678"


def test_texts_that_follow_too_soon_are_left_out() -> None:
    out = Terminal()
    line = TerminalLine(out, period_s=60)

    line.show("one")
    line.show("two")

    assert out.getvalue() == "\r\x1b[2Kone"


def test_the_line_is_erased_at_the_end_however_that_comes() -> None:
    out = Terminal()

    def interrupted() -> None:
        with TerminalLine(out) as line:
            line.show("one")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()

    assert out.getvalue() == "\r\x1b[2Kone\r\x1b[2K"


def test_what_was_never_written_is_not_erased() -> None:
    out = Terminal()

    with TerminalLine(out) as line:
        line.erase()

    assert out.getvalue() == ""


def test_after_it_was_erased_the_next_text_is_written_at_once() -> None:
    out = Terminal()
    line = TerminalLine(out, period_s=60)

    line.show("one")
    line.erase()
    line.show("two")

    assert out.getvalue().endswith("\r\x1b[2Ktwo")
