"""A worker process, for work that would keep the event loop from ticking at 20 Hz.

A thread would not do: it would hold the interpreter lock that the tick needs. The process is a new
interpreter and not a fork, so that it inherits no sockets and no locked locks. It has its own
session, so that Ctrl-C in the terminal does not reach it. It ends when this process ends for
whatever reason, also in the middle of a job.
"""

import asyncio
import errno
import os
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Protocol, TypeVar, TypeVarTuple, cast

from domain.errors import PilothouseError
from service.worker_process import (
    LENGTH_BYTES,
    OUT_OF_MEMORY,
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
_ENDING_S = 0.5
"""A process whose pipes are closed is about to end."""


class WorkerBusyError(PilothouseError):
    """The queue is full; the same request may be accepted later."""

    code = "BUSY"
    retry_after_s = 2

    def __init__(self) -> None:
        super().__init__(f"{QUEUE_LENGTH} requests of this kind are already waiting")
        self.hint = f"try again in {self.retry_after_s} s"


class TooComplexError(PilothouseError):
    """A job that needs more time or memory than a request may use."""

    code = "TOO_COMPLEX"

    def __init__(self, how: str) -> None:
        super().__init__(f"this is too complex: {how}")


class OutOfMemoryError(TooComplexError):
    """A job that needs more memory than a worker process may have."""

    code = "MEMORY"

    def __init__(self) -> None:
        PilothouseError.__init__(self, "there is not enough memory for this")
        self.hint = "ask for less at once, or give the service more memory (see `ulimit -v`)"


class WorkerClosedError(PilothouseError):
    """A job for a service that is shutting down."""

    code = "ENDING"

    def __init__(self) -> None:
        super().__init__("the service is shutting down")


class JobFailedError(Exception):
    """A bug in the program that occurred in the worker; the message is its traceback."""


class Jobs(Protocol):
    """Runs jobs that would block the event loop for too long, one after the other."""

    async def close(self) -> None:
        """Stop; unfinished jobs fail."""
        ...

    def require_room(self) -> None:
        """Check that a job would be taken, before its arguments are made at some cost.

        Raises:
            WorkerBusyError: The queue is full.
        """
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
    """Runs jobs in this process, for code that runs in a worker process already."""

    async def close(self) -> None:
        """Do nothing: no process was started."""

    def require_room(self) -> None:
        """Do nothing: there is no queue."""

    async def call(self, function: Callable[[*Given], Result], *arguments: *Given) -> Result:
        """Return what a function returns.

        Raises:
            PilothouseError: Raised by the function.
        """
        return function(*arguments)


class Worker:
    """Runs one job at a time in a process that is started for the first job."""

    def __init__(self, modules: Sequence[str] = (), deadline_s: float = DEADLINE_S) -> None:
        """Prepare; nothing is started yet.

        Args:
            modules: Imported by the process at its start, so that the first job is not delayed.
            deadline_s: Time limit of one job, s.
        """
        self._modules = tuple(modules)
        self._deadline_s = deadline_s
        self._process: Process | None = None
        self._turn = asyncio.Lock()
        self._jobs = 0
        self._is_closed = False

    async def close(self) -> None:
        """End the process; the running job, those in the queue and all later ones fail."""
        self._is_closed = True
        if self._process is not None and self._process.returncode is None:
            self._process.kill()
        async with self._turn:
            process, self._process = self._process, None
            if process is not None:
                await _end(process)

    def require_room(self) -> None:
        """Check that a job would be taken, before its arguments are made at some cost.

        Raises:
            WorkerBusyError: The queue is full.
        """
        if self._jobs > QUEUE_LENGTH:
            raise WorkerBusyError

    async def call(self, function: Callable[[*Given], Result], *arguments: *Given) -> Result:
        """Run a function in the worker, and return its result.

        Args:
            function: Defined at the top level of a module, since it is pickled by name.
            arguments: Passed to the function.

        Raises:
            WorkerBusyError: The queue is full.
            WorkerClosedError: `close` was called, before or during the job.
            TooComplexError: The job took too long, or ended the process.
            PilothouseError: Raised by the function.
            JobFailedError: The function has a bug.
        """
        self.require_room()
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
        """Send a job and wait for its reply; a process that fails is not used again.

        A process from an earlier job may have died since; then the job is sent to a new one.
        """
        is_new = self._process is None
        process = await self._running()
        try:
            async with asyncio.timeout(self._deadline_s):
                return await _ask(process, job)
        except BaseException as error:
            # Also when cancelled: the reply to this job must never be taken for that of the next.
            self._process = None
            is_ending = isinstance(error, asyncio.IncompleteReadError | ConnectionError)
            await _end(process, _ENDING_S if is_ending else 0.0)
            if isinstance(error, TimeoutError):
                how = f"it took longer than {self._deadline_s:g} s"
                raise TooComplexError(how) from error
            if is_ending:
                if self._is_closed:
                    raise WorkerClosedError from error
                if not is_new:
                    return await self._exchange(job)
                if process.returncode == OUT_OF_MEMORY:
                    raise OutOfMemoryError from error
                raise TooComplexError("it ended the process that worked on it") from error
            raise

    async def _running(self) -> Process:
        """Return the process, after starting a new one if there is none or it has died.

        Raises:
            WorkerClosedError: `close` was called, possibly while the process started; `close` then
                ends the process.
        """
        if self._is_closed:
            raise WorkerClosedError
        if self._process is None or self._process.returncode is not None:
            self._process = await _spawn(*self._modules)
            if self._is_closed:
                raise WorkerClosedError
        return self._process


async def _spawn(*modules: str) -> Process:
    """Start a process.

    Raises:
        OutOfMemoryError: There is no memory for it.
    """
    path = os.pathsep.join(entry or os.getcwd() for entry in sys.path)
    try:
        return await asyncio.create_subprocess_exec(
            sys.executable,
            "-P",
            "-c",
            # Not `-m`: the module would be __main__ there, and pickles name its classes.
            "from service.worker_process import main; main()",
            str(os.getpid()),
            *modules,
            stdin=PIPE,
            stdout=PIPE,
            # It works on one job at a time, and each further thread takes address space.
            env={"OPENBLAS_NUM_THREADS": "1", **os.environ, "PYTHONPATH": path},
            start_new_session=True,
        )
    except OSError as error:
        if error.errno not in (errno.ENOMEM, errno.EAGAIN):
            raise
        raise OutOfMemoryError from error


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
        raise ConnectionError("the worker did not send a reply")
    return reply


async def _end(process: Process, within_s: float = 0.0) -> None:
    """Kill a process and wait until it and its pipes are gone.

    Args:
        process: The process.
        within_s: How long it may take to end by itself, with an exit code that says why, s.
    """
    with suppress(TimeoutError):
        async with asyncio.timeout(within_s):
            await process.wait()
    if process.returncode is None:
        process.kill()
    await process.communicate()
