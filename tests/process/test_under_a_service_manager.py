"""What a service manager such as systemd is told by the real process."""

import signal
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.process import run, service

PATIENCE_S = 10.0


@pytest.fixture
def manager(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listening:
        listening.bind(str(tmp_path / "notify"))
        listening.settimeout(PATIENCE_S)
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        yield listening


def test_it_says_that_it_is_ready_that_it_lives_and_that_it_stops(
    manager: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("WATCHDOG_USEC", "200000")

    with service() as running:
        assert manager.recv(100) == b"READY=1"
        assert manager.recv(100) == b"WATCHDOG=1"
        assert manager.recv(100) == b"WATCHDOG=1"

        running.send_signal(signal.SIGTERM)
        while (told := manager.recv(100)) == b"WATCHDOG=1":
            pass
        code, _, _ = running.ended()

    assert told == b"STOPPING=1"
    assert code == 0


def test_a_manager_that_makes_no_sense_is_told_in_one_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("NOTIFY_SOCKET", "nowhere")

    code, output, errors = run("serve", "--port", "0")

    assert (code, output) == (2, "")
    assert errors.count("\n") == 1
    assert "NOTIFY_SOCKET" in errors
