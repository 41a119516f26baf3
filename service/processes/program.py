"""One program of a node: started, read and ended."""

import asyncio
import os
import signal
import sys
from asyncio.subprocess import DEVNULL, STDOUT, Process
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from domain.process_terms import ProcessExit
from service.processes.guard import ISOLATED, Guard
from service.processes.output_tail import OutputTail
from service.processes.program_child import NOT_FOUND, NOT_RUN

_CHILD = Path(__file__).with_name("program_child.py")
_READ_BYTES = 2**18
_READ_PAUSE_S = 0.01
"""Between two pieces of output: a program that prints without end leaves the loop time for others,
and is held up only beyond 25 MB/s."""
_LAST_WORDS_S = 0.5
"""How long a pipe may stay open that somebody else than the program holds."""
_COULD_NOT = {
    NOT_FOUND: "exit code 127: the command or its folder was not found",
    NOT_RUN: "exit code 126: the command cannot be run",
}


@dataclass(frozen=True, slots=True)
class ProgramSettings:
    """What is run for a node."""

    command: tuple[str, ...]
    """The program and its arguments; no shell reads them."""
    folder: str
    """Working directory, as an absolute path."""
    environment: Mapping[str, str] = field(default_factory=dict, repr=False)
    """Added to that of the service; it may hold secrets."""
    stop_s: float = 5.0
    """How long it has to end: SIGINT first, SIGTERM after half of it, SIGKILL at its end."""


class Program:
    """A program that runs, in a process group of its own."""

    def __init__(
        self, process: Process, settings: ProgramSettings, guard: Guard, output: asyncio.Task[None]
    ) -> None:
        self._process = process
        self._settings = settings
        self._guard = guard
        self._output = output
        self._is_gone = False
        """Nothing of its group is left, whose number may be that of another one soon."""

    @classmethod
    async def start(cls, settings: ProgramSettings, guard: Guard, tail: OutputTail) -> "Program":
        """Start a program.

        Args:
            settings: What to run.
            guard: Ends it with the service.
            tail: Gets what it prints.

        Raises:
            OSError: The system starts no more processes.
        """
        pipe = await guard.pipe()
        # A pipe of our own: whether it is closed says nothing about the end of the program.
        ours, theirs = os.pipe()
        try:
            process = await asyncio.create_subprocess_exec(
                sys.executable,
                *ISOLATED,
                str(_CHILD),
                str(pipe),
                settings.folder,
                *settings.command,
                stdin=DEVNULL,
                stdout=theirs,
                stderr=STDOUT,
                env={**os.environ, **settings.environment},
                pass_fds=(pipe,),
                start_new_session=True,
            )
        except OSError:
            os.close(ours)
            raise
        finally:
            os.close(theirs)
        guard.note_started(process.pid)
        return cls(process, settings, guard, asyncio.create_task(_read(ours, tail)))

    @property
    def pid(self) -> int:
        """Return the number of its process, which is that of its group as well."""
        return self._process.pid

    async def ended(self) -> ProcessExit:
        """Wait for the end; nothing of its group is left then."""
        await self._process.wait()
        return await self._clear_up()

    async def stop(self) -> ProcessExit:
        """End it, as politely as its time allows."""
        half_s = self._settings.stop_s / 2
        for number in (signal.SIGINT, signal.SIGTERM):
            self._send(number)
            with suppress(TimeoutError):
                async with asyncio.timeout(half_s):
                    return await self.ended()
        self._send(signal.SIGKILL)
        return await self.ended()

    async def _clear_up(self) -> ProcessExit:
        """End what the program started and left behind, and take its last words."""
        self._send(signal.SIGKILL)
        self._is_gone = True
        self._guard.note_ended(self.pid)
        await asyncio.wait([self._output], timeout=_LAST_WORDS_S)
        self._output.cancel()
        return _exit_of(self._process.returncode)

    def _send(self, number: signal.Signals) -> None:
        if self._is_gone:
            return
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self.pid, number)


async def _read(pipe: int, tail: OutputTail) -> None:
    """Take what comes through a pipe until all who could write to it have ended."""
    reader = asyncio.StreamReader(_READ_BYTES)
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(reader), os.fdopen(pipe, "rb", 0)
    )
    try:
        while data := await reader.read(_READ_BYTES):
            tail.add(data)
            await asyncio.sleep(_READ_PAUSE_S)
    finally:
        transport.close()


def _exit_of(code: int | None) -> ProcessExit:
    if code is None:
        return ProcessExit(reason="how it ended is not known")
    if code >= 0:
        return ProcessExit(code, reason=_COULD_NOT.get(code, ""))
    try:
        return ProcessExit(signal=signal.Signals(-code).name)
    except ValueError:
        return ProcessExit(signal=f"signal {-code}")
