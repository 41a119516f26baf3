"""The keys of a terminal."""

import asyncio
import io
import os
import pty
import sys
import termios
from collections.abc import Iterator
from contextlib import suppress

import pytest

from api.cli.monitor.keyboard import Keyboard, single_keys, take_single_keys


@pytest.fixture
def controller(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Return the other end of a terminal that is the standard input, in the foreground."""
    controller, terminal = pty.openpty()
    monkeypatch.setattr(os, "tcgetpgrp", lambda _: os.getpgrp())
    with os.fdopen(terminal, closefd=True) as stdin:
        monkeypatch.setattr(sys, "stdin", stdin)
        yield controller
    os.close(controller)


async def ends(typed: bytes, controller: int, within_s: float = 0.3) -> bool:
    """Tell whether keys end the monitor."""
    waiting = asyncio.create_task(Keyboard().until_quit())
    os.write(controller, typed)
    done, _ = await asyncio.wait({waiting}, timeout=within_s)
    waiting.cancel()
    await asyncio.gather(waiting, return_exceptions=True)
    return bool(done)


@pytest.mark.parametrize("typed", [b"q", b"Q", b"xq", b"\x1b[Aq"])
async def test_q_ends_the_monitor(typed: bytes, controller: int) -> None:
    with single_keys():
        assert await ends(typed, controller, within_s=10.0)


@pytest.mark.parametrize("typed", [b"x", b"\x1bOQ", b"\x1b[24~", b" "])
async def test_other_keys_do_not(typed: bytes, controller: int) -> None:
    with single_keys():
        assert not await ends(typed, controller)


async def test_in_the_background_nothing_is_read(
    controller: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "tcgetpgrp", lambda _: os.getpgrp() + 1)
    with single_keys():
        assert not await ends(b"q", controller)


async def test_without_a_terminal_there_are_no_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("q"))
    with single_keys():
        take_single_keys()
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(Keyboard().until_quit(), 0.05)


def test_keys_come_one_by_one_and_the_terminal_is_restored(controller: int) -> None:
    before = termios.tcgetattr(sys.stdin)
    with suppress(RuntimeError), single_keys():
        assert not termios.tcgetattr(sys.stdin)[3] & (termios.ECHO | termios.ICANON)
        # The shell resets it while the monitor is stopped.
        termios.tcsetattr(sys.stdin, termios.TCSANOW, before)
        take_single_keys()
        assert not termios.tcgetattr(sys.stdin)[3] & (termios.ECHO | termios.ICANON)
        raise RuntimeError
    assert termios.tcgetattr(sys.stdin) == before
    assert controller
