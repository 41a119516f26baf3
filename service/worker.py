"""One process beside ours, for work that would keep the event loop from its 20 Hz.

A thread would not do: it takes the interpreter's lock from the tick. The process is an interpreter
started anew, not a fork, so that it holds nothing of ours: no socket, no half-held lock. It is in a
session of its own, so that Ctrl-C in the terminal does not reach it; and it ends with us, however
we end, since its standard input ends then.
"""

import asyncio
import os
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar, TypeVarTuple, cast

from domain.errors import PilothouseError
from service.worker_process import (
    LENGTH_BYTES,
    ErrorParcel,
    Reply,
    large,
    numbers_in,
    pack,
    unpack,
)

Given = TypeVarTuple("Given")
Result = TypeVar("Result")

QUEUE_LENGTH = 4
DEADLINE_S = 10.0


class WorkerBusyError(PilothouseError):
    """Too much work is waiting already; the same may be accepted later."""

    code = "BUSY"
    retry_after_s = 2

    def __init__(self) -> None:
        super().__init__(f"{QUEUE_LENGTH} requests of this kind are waiting already")
        self.hint = f"try again in {self.retry_after_s} s"


class TooComplexError(PilothouseError):
    """Work that takes more time or memory than a request may have."""

    code = "TOO_COMPLEX"

    def __init__(self, how: str) -> None:
        super().__init__(f"this is too complex: {how}")


class WorkerClosedError(PilothouseError):
    """Work for a service that is ending."""

    code = "ENDING"

    def __init__(self) -> None:
        super().__init__("the service is ending, and begins no more work of this kind")


class JobFailedError(Exception):
    """A fault in the program, met in the worker; the message is its traceback."""


class Jobs(Protocol):
    """Does work that takes longer than the event loop may be kept, one job after the other."""

    async def close(self) -> None:
        """End for good; jobs that are not done fail."""
        ...

    async def call(self, function: Callable[[*Given], Result], *arguments: *Given) -> Result:
        """Return what a function returns.

        Args:
            function: One that a module names, since it may be sent by its name.
            arguments: What it is called with.

        Raises:
            PilothouseError: Raised by the function, or the job cannot be done.
        """
        ...


class InlineJobs:
    """Does jobs at once, for code that runs in a worker process already."""

    async def close(self) -> None:
        """Do nothing: there is no process."""

    async def call(self, function: Callable[[*Given], Result], *arguments: *Given) -> Result:
        """Return what a function returns.

        Raises:
            PilothouseError: Raised by the function.
        """
        return function(*arguments)


class Worker:
    """Does one job at a time in its own process, which is started when there is something to do."""

    def __init__(self, modules: Sequence[str] = (), deadline_s: float = DEADLINE_S) -> None:
        """Prepare; nothing is started yet.

        Args:
            modules: What the process imports at its start, so that the first job need not.
            deadline_s: How long one job may take.
        """
        self._modules = tuple(modules)
        self._deadline_s = deadline_s
        self._process: Process | None = None
        self._turn = asyncio.Lock()
        self._jobs = 0
        self._is_closed = False

    async def close(self) -> None:
        """End the process for good: the job that it is at, those that wait and any new one fail."""
        self._is_closed = True
        if self._process is not None and self._process.returncode is None:
            self._process.kill()
        async with self._turn:
            process, self._process = self._process, None
            if process is not None:
                await _end(process)

    async def call(self, function: Callable[[*Given], Result], *arguments: *Given) -> Result:
        """Return what a function returns, computed in the worker.

        Args:
            function: One that a module names, since it is sent by its name.
            arguments: What it is called with.

        Raises:
            WorkerBusyError: Too many jobs are waiting.
            WorkerClosedError: `close` was called, before or while it was done.
            TooComplexError: It took too long, or ended the process.
            PilothouseError: Raised by the function.
            JobFailedError: The function has a fault.
        """
        if self._jobs > QUEUE_LENGTH:
            raise WorkerBusyError
        self._jobs += 1
        try:
            async with self._turn:
                job = pack((function, tuple(map(large, arguments))))
                reply = await self._exchange(job)
        finally:
            self._jobs -= 1
        if isinstance(reply.value, ErrorParcel):
            raise reply.value.unpacked()
        if reply.outcome == "failed":
            raise JobFailedError(reply.value)
        return cast("Result", reply.value)

    async def _exchange(self, job: Sequence[bytes | memoryview]) -> Reply:
        """Send a job and wait for what becomes of it; a process that fails is not used again.

        One that was there before may have died before this job: then a new one is tried.
        """
        is_new = self._process is None
        process = await self._running()
        try:
            async with asyncio.timeout(self._deadline_s):
                return await _ask(process, job)
        except BaseException as error:
            # Also when cancelled: the reply to this job must never be taken for the next one's.
            self._process = None
            await _end(process)
            if isinstance(error, TimeoutError):
                how = f"it was not done within {self._deadline_s:g} s"
                raise TooComplexError(how) from error
            if isinstance(error, asyncio.IncompleteReadError | ConnectionError):
                if self._is_closed:
                    raise WorkerClosedError from error
                if not is_new:
                    return await self._exchange(job)
                raise TooComplexError("it ended the process that worked on it") from error
            raise

    async def _running(self) -> Process:
        """Return the process, or a new one if there is none or it has died.

        Raises:
            WorkerClosedError: `close` was called, maybe while the process started; it then ends it.
        """
        if self._is_closed:
            raise WorkerClosedError
        if self._process is None or self._process.returncode is not None:
            path = os.pathsep.join(entry or os.getcwd() for entry in sys.path)
            self._process = await asyncio.create_subprocess_exec(
                sys.executable,
                "-P",
                "-c",
                # Not `-m`: its module would be called __main__ there, and so would its classes.
                "from service.worker_process import main; main()",
                *self._modules,
                stdin=PIPE,
                stdout=PIPE,
                env={**os.environ, "PYTHONPATH": path},
                start_new_session=True,
            )
            if self._is_closed:
                raise WorkerClosedError
        return self._process


async def _ask(process: Process, job: Sequence[bytes | memoryview]) -> Reply:
    """Write a job and read the reply."""
    if process.stdin is None or process.stdout is None:
        raise ConnectionError("the worker has no pipes")
    for piece in job:
        process.stdin.write(piece)
        await process.stdin.drain()
    replies = process.stdout
    (count,) = numbers_in(await replies.readexactly(LENGTH_BYTES))
    lengths = numbers_in(await replies.readexactly(count * LENGTH_BYTES))
    reply = unpack([await replies.readexactly(length) for length in lengths])
    if not isinstance(reply, Reply):
        raise ConnectionError("the worker sent something else than a reply")
    return reply


async def _end(process: Process) -> None:
    """Kill a process and wait until it and its pipes are gone."""
    if process.returncode is None:
        process.kill()
    await process.communicate()
