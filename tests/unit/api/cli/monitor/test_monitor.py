import asyncio
import io
import json
import os
import signal
import sys
from collections.abc import Callable

import pytest

from api.cli.monitor import monitor as module
from api.cli.monitor.monitor import monitor
from api.cli.monitor.store import Json
from api.cli.monitor.watch import Watch
from api.client.address import Address
from api.client.outcomes import NoAnswerError, ServiceProblemError
from tests.support.monitor import URL, after, frame, hello, named, part, stop, system_state

Output = pytest.CaptureFixture[str]

WHOLE = (
    frame(parts=named("name", part("arm")), signals={}, task=None, holds={}, emergency_stop=stop()),
)


class Link:
    """Says what a test tells it to, and then waits, or does what the test says."""

    says: tuple[Json, ...] = ()
    then: Callable[[], None] = staticmethod(lambda: None)
    tokens: tuple[str | None, ...] = ()

    def __init__(self, address: Address, watch: Watch) -> None:
        Link.tokens = (*Link.tokens, address.token)
        self._watch = watch

    async def serve(self) -> None:
        for message in (hello(), *Link.says):
            self._watch.take(message)
        Link.then()
        await asyncio.Event().wait()

    run = serve


@pytest.fixture(autouse=True)
def link(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "Link", Link)
    monkeypatch.setattr(Link, "says", WHOLE)
    monkeypatch.setattr(Link, "tokens", ())
    for variable in ("PILOTHOUSE_TOKEN", "PILOTHOUSE_TOKEN_FILE", "COLUMNS"):
        monkeypatch.delenv(variable, raising=False)


def end_after(monkeypatch: pytest.MonkeyPatch, how: Callable[[], None]) -> None:
    monkeypatch.setattr(Link, "then", staticmethod(how))


def interrupt() -> None:
    os.kill(os.getpid(), signal.SIGINT)


def test_once_is_one_picture(capsys: Output) -> None:
    assert monitor(URL, "text", once=True) == 0

    told = capsys.readouterr().out
    assert told.splitlines()[1] == f" Model: robot.yaml  {URL}"
    assert "\x1b" not in told
    assert all(len(line) <= 80 for line in told.splitlines())


def test_once_as_json_is_one_object(capsys: Output) -> None:
    assert monitor(URL, "json", once=True) == 0

    assert json.loads(capsys.readouterr().out)["parts"] == {"arm": part("arm")}


def test_once_of_a_robot_in_error_is_a_picture_all_the_same(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    state = frame(system_state=system_state("ERROR", "battery is low"))
    monkeypatch.setattr(Link, "says", ({**WHOLE[0], **state},))

    assert monitor(URL, "text", once=True) == 0
    assert "ERROR  battery is low" in capsys.readouterr().out


def test_once_waits_for_the_whole_picture_but_not_for_ever(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    monkeypatch.setattr(module, "_PATIENCE_S", 0.01)
    monkeypatch.setattr(Link, "says", WHOLE[1:])

    with pytest.raises(NoAnswerError, match="no complete state"):
        monitor(URL, "text", once=True)
    assert capsys.readouterr().out == ""


def test_a_refusal_is_told_to_who_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> None:
        raise ServiceProblemError({"detail": "a token is needed"})

    monkeypatch.setattr(Link, "says", ())
    end_after(monkeypatch, refuse)

    for once in (True, False):
        with pytest.raises(ServiceProblemError, match="a token is needed"):
            monitor(URL, "text", once=once)


def test_the_token_is_that_of_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PILOTHOUSE_TOKEN", "s3cret")

    monitor(URL, "json", once=True)

    assert Link.tokens == ("s3cret",)


def test_a_token_that_cannot_be_used_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PILOTHOUSE_TOKEN", "two words")

    with pytest.raises(NoAnswerError, match="PILOTHOUSE_TOKEN"):
        monitor(URL, "text", once=True)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_log_ends_well_when_it_is_told_to(
    monkeypatch: pytest.MonkeyPatch, capsys: Output, number: signal.Signals
) -> None:
    changed = frame(after(1), system_state=system_state("RUNNING"))
    monkeypatch.setattr(Link, "says", (*WHOLE, changed, changed))
    end_after(monkeypatch, lambda: os.kill(os.getpid(), number))

    assert monitor(URL, "text", once=False) == 0

    told = capsys.readouterr().out
    assert told.count("System Modes Monitor") == 2
    assert "\x1b" not in told


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def on_a_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Let the output be a terminal; not a fixture, since pytest has its own for each phase."""
    shown = Terminal()
    monkeypatch.setattr(sys, "stdout", shown)
    monkeypatch.setattr(sys, "stdin", io.StringIO())
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(module, "REDRAW_S", 0.001)
    return shown


def test_on_a_terminal_it_is_drawn_on_a_screen_of_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    terminal = on_a_terminal(monkeypatch)

    def later() -> None:
        asyncio.get_running_loop().call_later(0.05, interrupt)

    end_after(monkeypatch, later)

    assert monitor(URL, "text", once=False) == 0

    text = terminal.getvalue()
    assert text.index("\x1b[?1049h") < text.index("arm") < text.index("\x1b[?1049l")
    # Many pictures later, what has not changed was written once.
    assert text.count("arm") == 1


def test_a_terminal_that_can_only_print_gets_a_log(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    terminal = on_a_terminal(monkeypatch)
    monkeypatch.setenv("TERM", "dumb")
    end_after(monkeypatch, interrupt)

    assert monitor(URL, "text", once=False) == 0

    assert "arm" in terminal.getvalue()
    assert "\x1b[?1049h" not in terminal.getvalue()


def test_no_color_leaves_the_colours_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    terminal = on_a_terminal(monkeypatch)
    error = frame(system_state=system_state("ERROR", "battery is low"))
    monkeypatch.setattr(Link, "says", ({**WHOLE[0], **error},))
    monkeypatch.setenv("COLORTERM", "")
    monitor(URL, "text", once=True)
    colored = terminal.getvalue()
    monkeypatch.setenv("NO_COLOR", "1")

    monitor(URL, "text", once=True)

    assert "31m" in colored
    assert "31m" not in terminal.getvalue()[len(colored) :]
