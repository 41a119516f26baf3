"""A service, or what stands beside it in a bench, whose use of the machine is read meanwhile."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from tests.support.bench import PROJECT
from tests.support.process import COMMAND, ServiceProcess
from tests.support.process_usage import ProcessUsage, pinned_to

PILOTHOUSE = (*COMMAND, "serve", "--port", "0")
"""Further options may follow."""


@dataclass(frozen=True, slots=True)
class MeasuredService:
    """A process that listens, and what it uses."""

    process: ServiceProcess
    usage: ProcessUsage

    @property
    def host(self) -> str:
        """Address and port."""
        return str(self.process.url).removeprefix("http://")


def module(name: str, *arguments: str) -> tuple[str, ...]:
    """Return the command that runs a module of the tests."""
    return (sys.executable, "-m", name, *arguments)


@contextmanager
def measured_service(
    command: Sequence[str], core: int | None = None, environment: Mapping[str, str] | None = None
) -> Iterator[MeasuredService]:
    """Run a process that says where it listens, as long as the context lasts.

    Args:
        command: What to run. It prints as `pilothouse serve` does: its address behind `page`, and
            a line with `Ctrl-C` last.
        core: The only one to run on; None: any.
        environment: Variables beside those of this process.
    """
    with (
        tempfile.TemporaryDirectory(prefix="pilothouse-state-") as state,
        tempfile.TemporaryFile("w+") as complaints,
    ):
        with pinned_to(core):
            process = subprocess.Popen(
                command,
                cwd=PROJECT,
                env={**os.environ, "XDG_STATE_HOME": state, **(environment or {})},
                stdout=subprocess.PIPE,
                stderr=complaints,
                text=True,
            )
        with process:
            try:
                service = ServiceProcess(process, complaints)
                yield MeasuredService(service, ProcessUsage(process.pid))
            finally:
                process.kill()
