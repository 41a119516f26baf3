"""A runner of docker/, started and ended by a test."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import httpx

from tests.support.container import free_port
from tests.support.shared import PROJECT

FOLDER = PROJECT / "docker"
PATIENCE_S = 60.0


def environment(more: dict[str, str]) -> dict[str, str]:
    """Return variables with which `--here` finds the programs of this interpreter, and more."""
    own = str(Path(sys.executable).parent)
    return os.environ | {"PATH": f"{own}{os.pathsep}{os.environ['PATH']}"} | more


def run(name: str, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a runner to its end.

    Args:
        name: Of the script.
        arguments: Its arguments.
        variables: Beside those of `environment`.
    """
    return subprocess.run(
        [FOLDER / name, *arguments],
        env=environment(variables),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )


class Runner:
    """A runner that serves until it is ended.

    Args:
        process: Its process.
        output: What it and all that it started write to.
        url: Where its page will be.
    """

    def __init__(self, process: subprocess.Popen[str], output: IO[str], url: str) -> None:
        self._process = process
        self._output = output
        self.url = url
        """Where its page is."""

    def wait_until_ready(self) -> None:
        """Wait for the service.

        Raises:
            AssertionError: The runner ended, or the service was not ready in time.
        """
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            assert self._process.poll() is None, f"it ended:\n{self.said()}"
            try:
                if httpx.get(f"{self.url}/readyz").status_code == 200:
                    return
            except httpx.TransportError:
                pass
            # Polled, since nothing tells from outside that the port is open now.
            time.sleep(0.05)
        raise AssertionError(f"it is not ready:\n{self.said()}")

    def wait_for_nodes(self) -> None:
        """Wait until the service hears all nodes.

        Raises:
            AssertionError: It does not in time.
        """
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            nodes = httpx.get(f"{self.url}/nodes").json()["items"]
            if all(node["reachable"] for node in nodes):
                return
            time.sleep(0.1)
        raise AssertionError(f"nodes are missing:\n{self.said()}")

    def ended_by(self, number: signal.Signals) -> int:
        """Send a signal to the runner alone; return its exit code."""
        self._process.send_signal(number)
        return self.ended()

    def ended(self) -> int:
        """Wait for the end of the runner; return its exit code."""
        return self._process.wait(PATIENCE_S)

    def signal_one(self, argument: str, number: signal.Signals) -> None:
        """Send a signal to the one process that the runner started with such a last argument."""
        (pid,) = (
            pid
            for pid in self.left_behind()
            if Path(f"/proc/{pid}/cmdline").read_text().rstrip("\0").endswith(argument)
        )
        os.kill(pid, number)

    def left_behind(self) -> list[int]:
        """Return the processes of its session, to which all belong that it started."""
        session = self._process.pid
        return [
            int(path.name)
            for path in Path("/proc").iterdir()
            if path.name.isdecimal() and _session(path) == session
        ]

    def said(self) -> str:
        """Return all that was printed so far."""
        self._output.seek(0)
        return self._output.read()

    def kill(self) -> None:
        """End what is left of it."""
        for pid in self.left_behind():
            os.kill(pid, signal.SIGKILL)
        self._process.wait()


@contextmanager
def running(name: str, *arguments: str, **variables: str) -> Iterator[Runner]:
    """Run a runner on a port of its own as long as the context lasts.

    Args:
        name: Of the script.
        arguments: Besides `--port`.
        variables: Beside those of `environment`.
    """
    port = free_port()
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen(
            [FOLDER / name, "--port", str(port), *arguments],
            env=environment(variables),
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        runner = Runner(process, output, f"http://127.0.0.1:{port}")
        try:
            yield runner
        finally:
            runner.kill()


def _session(process: Path) -> int | None:
    """Return the session of a process in /proc; None: it is gone, or only waits to be collected."""
    try:
        state, _, _, session, *_ = (process / "stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return None if state == "Z" else int(session)
