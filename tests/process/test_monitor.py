"""`pilothouse monitor` as a process of its own, beside a real service."""

import fcntl
import json
import os
import pty
import select
import signal
import socket
import struct
import subprocess
import termios
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import httpx
import pytest

from tests.support.process import COMMAND, ServiceProcess, run, service


def test_once_is_the_whole_picture_as_plain_text() -> None:
    with service() as running:
        httpx.post(
            f"{running.url}/systems/actuation/mode?wait=20",
            json={"mode": "PERFORMANCE"},
            timeout=30,
        )
        code, output, errors = run("monitor", running.url, "--once")

    assert (code, errors) == (0, "")
    assert "\x1b" not in output
    lines = [line.split() for line in output.splitlines()]
    cells = [[cell.strip() for cell in line.split("|")] for line in output.splitlines()]
    assert ["actuation", "active", "active(*)", "PERFORMANCE", "PERFORMANCE(*)"] in cells
    assert ["drive_base", "active", "active", "FAST", "FAST(*)"] in cells
    assert ["Model:", "actuation.yaml", running.url] == lines[1][:3]
    assert ["battery_level", "100", "%", "now", "ok"] in lines
    assert all(len(line) <= 80 for line in output.splitlines())


def test_once_as_json_is_one_object_with_each_member_as_the_interface_has_it() -> None:
    with service() as running:
        httpx.post(f"{running.url}/signals/battery_level", json={"value": 0.42})
        systems = httpx.get(f"{running.url}/systems").json()
        before, after = None, _holds(running)
        # On a busy machine the hold of a stale pose may come or go meanwhile.
        while before != after:
            before = after
            code, output, errors = run("monitor", running.url, "--once", "--format", "json")
            after = _holds(running)

    assert (code, errors) == (0, "")
    seen = json.loads(output)
    assert list(seen) == [
        "at",
        "system_state",
        "parts",
        "signals",
        "task",
        "vehicle",
        "emergency_stop",
        "holds",
        "errors",
        "reactions",
        "devices",
        "this_device",
    ]
    assert seen["system_state"]["errors"] == ["BATTERY_LOW"]
    assert seen["parts"]["actuation"] == systems["items"][0]
    assert seen["holds"] == after


def _holds(running: ServiceProcess) -> object:
    return httpx.get(f"{running.url}/holds").json()["items"]


def test_where_no_service_is_that_is_told_in_one_line() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]

    code, output, errors = run("monitor", f"http://127.0.0.1:{port}", "--once")

    assert (code, output) == (2, "")
    assert errors == (
        f"pilothouse: no service answers at http://127.0.0.1:{port}: is it running?\n"
    )


@pytest.mark.parametrize("ending", ["Ctrl-C", "SIGTERM", "q"])
def test_on_a_terminal_it_follows_an_error_and_leaves_the_terminal_as_it_was(ending: str) -> None:
    with service() as running, _on_a_terminal("monitor", "--url", running.url) as terminal:
        begin = _read_until(terminal.controller, b"manipulator")
        httpx.post(f"{running.url}/signals/battery_level", json={"value": 0.42})
        error = _read_until(terminal.controller, b"battery 42 % is below 50 %")
        match ending:
            case "Ctrl-C":
                os.write(terminal.controller, b"\x03")
            case "SIGTERM":
                terminal.process.send_signal(signal.SIGTERM)
            case _:
                os.write(terminal.controller, b"x\x1bOQ")
                assert terminal.process.poll() is None
                os.write(terminal.controller, b"q")
        end = _read_until(terminal.controller, b"\x1b[?25h")
        code = terminal.process.wait(10)
        after = terminal.modes()

    assert b"\x1b[?1049h" in begin
    # Only what changed is written.
    assert b"manipulator" not in error
    assert b"\x1b[?1049l" in end
    assert code == 0
    assert after == terminal.before


def test_without_a_keyboard_it_is_drawn_all_the_same() -> None:
    with (
        service() as running,
        _on_a_terminal("monitor", running.url, has_keyboard=False) as terminal,
    ):
        _read_until(terminal.controller, b"manipulator")
        terminal.process.send_signal(signal.SIGINT)
        assert terminal.process.wait(10) == 0


@dataclass
class _Terminal:
    """A terminal, with a command in its foreground."""

    process: "subprocess.Popen[bytes]"
    controller: int
    """Its other end: what is written here is typed."""
    number: int
    before: list[Any]
    """Its modes before the command began."""

    def modes(self) -> list[Any]:
        return termios.tcgetattr(self.number)


@contextmanager
def _on_a_terminal(*command: str, has_keyboard: bool = True) -> Iterator[_Terminal]:
    controller, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    before = termios.tcgetattr(terminal)
    process = subprocess.Popen(
        [*COMMAND, *command],
        stdin=terminal if has_keyboard else subprocess.DEVNULL,
        stdout=terminal,
        stderr=terminal,
        env={**os.environ, "TERM": "xterm-256color"},
        start_new_session=True,
        preexec_fn=_own_terminal,
    )
    try:
        yield _Terminal(process, controller, terminal, before)
    finally:
        process.kill()
        process.wait()
        os.close(controller)
        os.close(terminal)


def _own_terminal() -> None:
    """Make the standard output the terminal of a new session, as a login does."""
    fcntl.ioctl(1, termios.TIOCSCTTY, 0)


def _read_until(controller: int, wanted: bytes) -> bytes:
    """Return what a terminal is written, up to and with some text; the test limits the time."""
    seen = b""
    while wanted not in seen:
        select.select([controller], [], [])
        seen += os.read(controller, 65_536)
    return seen
