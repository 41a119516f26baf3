"""The process that ends programs once the service has ended."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from service.processes import guard_child

FILE = Path(guard_child.__file__)
ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""What ends a service."""


@contextmanager
def program(*command: str) -> Iterator[subprocess.Popen[str]]:
    """Run a program in a group of its own, until the test has ended at the latest."""
    with subprocess.Popen(
        command, start_new_session=True, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def guard() -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-I", "-S", str(FILE)], stdin=subprocess.PIPE, text=True
    )


def test_what_runs_when_the_service_has_ended_is_ended() -> None:
    with program("sleep", "100") as known, program("sleep", "100") as ended, guard() as it:
        it.communicate(f"+{known.pid}\n+{ended.pid}\n-{ended.pid}\n", timeout=20)

        assert known.wait(20) == -signal.SIGINT
        assert ended.poll() is None, "its group is none of ours any more"


def test_what_does_not_listen_is_killed() -> None:
    stubborn = "trap '' INT; echo ready; while true; do sleep 0.05; done"
    with program("sh", "-c", stubborn) as known, guard() as it:
        assert known.stdout is not None
        assert known.stdout.readline() == "ready\n"
        it.communicate(f"+{known.pid}\n", timeout=20)

        assert known.wait(20) == -signal.SIGKILL


def test_the_guard_is_not_ended_by_what_ends_the_service() -> None:
    with guard() as it:
        assert it.stdin is not None
        while not all(_ignores(it.pid, number) for number in ENDS):
            os.sched_yield()
        for number in ENDS:
            it.send_signal(number)
        it.stdin.close()

        assert it.wait(20) == 0


def _ignores(pid: int, number: signal.Signals) -> bool:
    status = Path(f"/proc/{pid}/status").read_text()
    (mask,) = (line.split()[1] for line in status.splitlines() if line.startswith("SigIgn:"))
    return bool(int(mask, 16) & 1 << (number - 1))


def test_signals_reach_groups_that_there_are() -> None:
    with program("sleep", "100") as known:
        assert guard_child.send({known.pid}, 0)
    assert not guard_child.send({known.pid}, 0)
