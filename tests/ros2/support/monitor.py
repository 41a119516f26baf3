"""`pilothouse monitor --ros2` in a process of its own, read as a program reads it."""

import asyncio
import json
import signal
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Any

from tests.ros2.support.service import Shown
from tests.support.process import COMMAND
from tests.support.shared import PROJECT

MODEL = str(PROJECT / "service" / "example" / "actuation.yaml")
_LONGEST_LINE = 1 << 20


class Monitor:
    """A monitor that writes a line of JSON for each change.

    Args:
        process: The monitor.
    """

    def __init__(self, process: Process) -> None:
        self._process = process
        self._parts: dict[str, Any] = {}

    async def until(self, is_so: Callable[["Monitor"], bool]) -> None:
        """Read on until something is shown; the test limits the time."""
        assert self._process.stdout is not None
        while not (self._parts and is_so(self)):
            line = await self._process.stdout.readline()
            assert line, f"the monitor ended; it showed {self._parts}"
            self._parts = json.loads(line)["parts"]

    def actual(self) -> Shown:
        """Return state and mode of every part, as shown last."""
        return self._shown("actual")

    def targets(self) -> Shown:
        """Return the target of every part that has one."""
        return self._shown("target")

    def is_reachable(self, node: str) -> bool:
        """Tell whether a node is shown as reachable."""
        return bool(self._parts[node]["reachable"])

    async def interrupt(self) -> tuple[int, str]:
        """Press Ctrl-C; return the exit code and what it complained of."""
        self._process.send_signal(signal.SIGINT)
        _, complaints = await self._process.communicate()
        assert self._process.returncode is not None
        return self._process.returncode, complaints.decode()

    def _shown(self, what: str) -> Shown:
        return {
            name: (part[what]["state"], part[what]["mode"])
            for name, part in self._parts.items()
            if part[what] is not None
        }


@asynccontextmanager
async def monitor() -> AsyncIterator[Monitor]:
    """Run a monitor as long as the context lasts."""
    process = await asyncio.create_subprocess_exec(
        *COMMAND,
        *("monitor", "--ros2", MODEL, "--format", "json"),
        stdout=PIPE,
        stderr=PIPE,
        limit=_LONGEST_LINE,
    )
    try:
        yield Monitor(process)
    finally:
        if process.returncode is None:
            process.kill()
            await process.communicate()


def table_of(picture: str) -> list[str]:
    """Return the rows of the table of systems and nodes in a picture, with titles and sections."""
    lines = picture.splitlines()
    begin = next(place for place, line in enumerate(lines) if line.strip().startswith("part |"))
    end = next(place for place, line in enumerate(lines) if line.startswith("-----"))
    return lines[begin:end]
