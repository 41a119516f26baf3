"""The process that holds all clients of a bench, as the bench sees it."""

import json
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from tests.support.bench import PROJECT
from tests.support.measured_service import module
from tests.support.process_usage import ProcessUsage, pinned_to


@dataclass(frozen=True, slots=True)
class Seen:
    """What all clients saw between two moments."""

    frames: int
    lost: int
    """Numbers that a client missed, of all clients together."""
    frame_bytes: float
    delay: dict[str, float]
    """Quantiles of the time behind what a frame says of itself."""
    spread: dict[str, float]
    """Quantiles of the time behind the first client that had the same frame."""
    ended: int
    """Clients whose connection has ended, since the process began."""


class Load:
    """Clients in a process of their own.

    Args:
        process: Runs `load_client`, with its input and output in pipes.
    """

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self.usage = ProcessUsage(process.pid)

    def connect(self, count: int) -> int:
        """Have so many clients; return how many were accepted."""
        return int(self._ask("connect", count)["connected"])

    def begin(self) -> None:
        """Begin to note what arrives."""
        self._ask("begin")

    def end(self) -> Seen:
        """Return what arrived since then."""
        return Seen(**self._ask("end"))

    def stop_reading(self) -> int:
        """Let one client read no more; return its port."""
        return int(self._ask("stop_reading")["port"])

    def _ask(self, *command: object) -> dict[str, Any]:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write(json.dumps(command) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        assert line, "the load client has ended"
        answer: dict[str, Any] = json.loads(line)
        return answer


@contextmanager
def load(host: str, path: str, core: int | None = None) -> Iterator[Load]:
    """Run clients as long as the context lasts.

    Args:
        host: Address and port of the server.
        path: Of the stream.
        core: The only one to run on; None: any.
    """
    with pinned_to(core):
        process = subprocess.Popen(
            module("tests.support.fan_out.load_client", host, path),
            cwd=PROJECT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
    with process:
        try:
            yield Load(process)
        finally:
            process.kill()
