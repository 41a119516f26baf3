"""A real `pilothouse serve`, started and ended by a test."""

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import websockets
from websockets.asyncio.client import ClientConnection

COMMAND = (str(Path(sys.executable).with_name("pilothouse")),)

_ADDRESS = re.compile(r"page\s+(http://\S+)/")
_PATIENCE_S = 20.0


class ServiceProcess:
    """A service that listens.

    Args:
        process: The process, with its output in a pipe.
        complaints: What it writes its standard error to.
    """

    def __init__(self, process: subprocess.Popen[str], complaints: IO[str]) -> None:
        self._process = process
        self._complaints = complaints
        self.greeting = self._read_greeting()
        """What it printed when it began."""
        self.url = _ADDRESS.findall(self.greeting)[0]
        """Where it listens."""

    @property
    def stream_url(self) -> str:
        """Address of the stream."""
        return f"{self.url.replace('http', 'ws', 1)}/ws"

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def runs(self) -> bool:
        """Tell whether it has not ended."""
        return self._process.poll() is None

    def send_signal(self, number: signal.Signals) -> None:
        """Send SIGTERM, SIGINT, ..."""
        self._process.send_signal(number)

    def kill(self) -> None:
        """End it as a power cut would."""
        self._process.kill()
        self._process.wait()

    def ended(self, within_s: float = 10.0) -> tuple[int, float, str]:
        """Wait for the end; return the exit code, the seconds that took, and its complaints."""
        start = time.monotonic()
        code = self._process.wait(within_s)
        return code, time.monotonic() - start, self._complaints_so_far()

    def memory_bytes(self) -> int:
        """Return the resident memory."""
        pages = int(Path(f"/proc/{self._process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")

    def _read_greeting(self) -> str:
        """Read up to the line that ends it; the time is limited by that of the test."""
        lines = []
        for line in self._process.stdout or ():
            lines.append(line)
            if "Ctrl-C" in line:
                return "".join(lines)
        raise AssertionError(f"it did not begin to serve:\n{self._complaints_so_far()}")

    def _complaints_so_far(self) -> str:
        self._complaints.seek(0)
        return self._complaints.read()


@contextmanager
def service(*arguments: str, command: tuple[str, ...] = COMMAND) -> Iterator[ServiceProcess]:
    """Run `pilothouse serve` on a free port as long as the context lasts.

    Args:
        arguments: More options.
        command: What to run instead of `pilothouse`.
    """
    with _serving(*command, "serve", "--port", "0", *arguments) as process:
        yield process


@contextmanager
def device(
    name: str, *arguments: str, command: tuple[str, ...] = COMMAND
) -> Iterator[ServiceProcess]:
    """Run `pilothouse device` on a free port as long as the context lasts.

    Args:
        name: Of the device.
        arguments: Model, and more options.
        command: What to run instead of `pilothouse`.
    """
    with _serving(*command, "device", name, "--port", "0", *arguments) as process:
        yield process


@contextmanager
def replay_page(folder: Path, *arguments: str) -> Iterator[ServiceProcess]:
    """Run `pilothouse replay --page` on a free port as long as the context lasts.

    Args:
        folder: What was recorded.
        arguments: More options.
    """
    with _serving(*COMMAND, "replay", str(folder), "--page", "--port", "0", *arguments) as process:
        yield process


@contextmanager
def _serving(*command: str) -> Iterator[ServiceProcess]:
    # A pipe that nobody reads would stop the service once it is full.
    with (
        tempfile.TemporaryDirectory(prefix="pilothouse-state-") as state,
        tempfile.TemporaryFile("w+") as complaints,
        subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=complaints,
            text=True,
            env={**os.environ, "XDG_STATE_HOME": state},
        ) as process,
    ):
        try:
            yield ServiceProcess(process, complaints)
        finally:
            process.kill()


def run(*arguments: str, within_s: float = _PATIENCE_S) -> tuple[int, str, str]:
    """Run `pilothouse` to its end; return the exit code, its output, and what it complained of."""
    done = subprocess.run(
        [*COMMAND, *arguments], capture_output=True, text=True, timeout=within_s, check=False
    )
    return done.returncode, done.stdout, done.stderr


def connect(url: str) -> websockets.connect:
    """Return a connection to a stream.

    Without a limit to what it keeps: at the usual one it stops to read, and then its own closing
    handshake takes ten seconds.
    """
    return websockets.connect(url, max_queue=None)


async def read_on(client: ClientConnection) -> None:
    """Read until the connection is closed.

    Raises:
        ConnectionClosed: By whom and why.
    """
    while True:
        await client.recv()
