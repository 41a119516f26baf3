"""A real `pilothouse serve`, started and ended by a test."""

import asyncio
import os
import re
import signal
import sys
import time
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from websockets.asyncio.client import ClientConnection

START_TIMEOUT_S = 20.0
_ADDRESS = re.compile(r"page\s+(http://\S+)/")

COMMAND = (str(Path(sys.executable).with_name("pilothouse")),)


class ServiceProcess:
    """A service that listens.

    Args:
        process: The process.
        url: Where it listens.
        greeting: What it printed when it began.
    """

    def __init__(self, process: Process, url: str, greeting: str) -> None:
        self.url = url
        self.greeting = greeting
        self._process = process

    @property
    def stream_url(self) -> str:
        """Address of the stream."""
        return f"{self.url.replace('http', 'ws', 1)}/ws"

    @property
    def runs(self) -> bool:
        """Tell whether it has not ended."""
        return self._process.returncode is None

    def send_signal(self, number: signal.Signals) -> None:
        """Send SIGTERM, SIGINT, ..."""
        self._process.send_signal(number)

    async def ended(self, within_s: float = 10.0) -> tuple[int, float, str]:
        """Wait for the end; return the exit code, the seconds that took, and its complaints."""
        start = time.monotonic()
        _, errors = await asyncio.wait_for(self._process.communicate(), within_s)
        assert self._process.returncode is not None
        return self._process.returncode, time.monotonic() - start, errors.decode()

    def memory_bytes(self) -> int:
        """Return the resident memory."""
        pages = int(Path(f"/proc/{self._process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE")


@asynccontextmanager
async def service(
    *arguments: str, command: tuple[str, ...] = COMMAND
) -> AsyncIterator[ServiceProcess]:
    """Run `pilothouse serve` on a free port as long as the context lasts.

    Args:
        arguments: More options.
        command: What to run instead of `pilothouse`.
    """
    process = await asyncio.create_subprocess_exec(
        *command, "serve", "--port", "0", *arguments, stdout=PIPE, stderr=PIPE
    )
    try:
        yield await asyncio.wait_for(_greeted(process), START_TIMEOUT_S)
    finally:
        if process.returncode is None:
            process.kill()
        await process.communicate()


async def run(*arguments: str, within_s: float = 20.0) -> tuple[int, str, str]:
    """Run `pilothouse` to its end; return the exit code, its output, and what it complained of."""
    process = await asyncio.create_subprocess_exec(*COMMAND, *arguments, stdout=PIPE, stderr=PIPE)
    output, errors = await asyncio.wait_for(process.communicate(), within_s)
    assert process.returncode is not None
    return process.returncode, output.decode(), errors.decode()


async def read_on(client: ClientConnection) -> None:
    """Read until the connection is closed.

    Raises:
        ConnectionClosed: By whom and why.
    """
    while True:
        await client.recv()


async def _greeted(process: Process) -> ServiceProcess:
    assert process.stdout is not None
    assert process.stderr is not None
    greeting = ""
    while line := (await process.stdout.readline()).decode():
        greeting += line
        if "Ctrl-C" in line and (found := _ADDRESS.search(greeting)):
            return ServiceProcess(process, found[1], greeting)
    errors = (await process.stderr.read()).decode()
    raise AssertionError(f"it did not begin to serve:\n{greeting}{errors}")
