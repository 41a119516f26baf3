"""Calls a function in a forked process, which sees everything as it was at that moment.

A consistent copy of a robot of 10,000 nodes takes most of a second to make. The fork takes some
milliseconds, and this process goes on meanwhile.
"""

import asyncio
import gc
import os
import signal
import traceback
from collections.abc import Callable
from contextlib import suppress

_PATIENCE_S = 30.0
_FIRST_OTHER_FD = 3
_NICENESS = 5
_DONE, _FAILED = b"=", b"!"


class ForkedCallError(RuntimeError):
    """The forked process ended, or was ended, without a result."""


async def forked_call(function: Callable[[], bytes]) -> bytes:
    """Return what a function returns that reads the state of this process as it is now.

    The process is forked before this coroutine first suspends.

    Args:
        function: Must not use threads, files or the event loop: none of them exist in the fork.

    Raises:
        OSError: The process cannot be forked, for want of memory or processes.
        ForkedCallError: It failed, or took longer than 30 s.
    """
    reading, writing = os.pipe()
    try:
        child = os.fork()
    except OSError:
        os.close(reading)
        os.close(writing)
        raise
    if child == 0:
        _do(function, writing)
    os.close(writing)
    try:
        async with asyncio.timeout(_PATIENCE_S):
            outcome = await _read(reading)
    except TimeoutError:
        outcome = _FAILED + b"it took too long"
    finally:
        _end(child)
    if not outcome.startswith(_DONE):
        raise ForkedCallError(outcome.removeprefix(_FAILED).decode() or "it was ended")
    return outcome[len(_DONE) :]


def _end(child: int) -> None:
    """Kill a process, without effect on one that has ended and waits for this."""
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)


async def _read(fd: int) -> bytes:
    """Return what comes through a pipe until its end, and close it."""
    reader = asyncio.StreamReader()
    pipe = os.fdopen(fd, "rb", buffering=0)
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(reader), pipe
    )
    try:
        return await reader.read()
    finally:
        transport.close()


def _do(function: Callable[[], bytes], writing: int) -> None:
    """Be the forked process: write the result, and end without cleaning up what is the parent's."""
    try:
        _close_all_but(writing)
        signal.set_wakeup_fd(-1)
        for ending in (signal.SIGTERM, signal.SIGHUP):
            signal.signal(ending, signal.SIG_DFL)
        os.nice(_NICENESS)
        gc.disable()
        _write(writing, _DONE, function())
    except BaseException:
        _write(writing, _FAILED, traceback.format_exc().encode())
    finally:
        # The pipe ends with the process: whoever reads that need not wait for the process then.
        os._exit(0)


def _close_all_but(kept: int) -> None:
    """Close files: connections that the service closes meanwhile must not stay open here."""
    # Only those that are open: the limit on descriptors may be a thousand million.
    for fd in map(int, os.listdir("/dev/fd")):
        if fd >= _FIRST_OTHER_FD and fd != kept:
            with suppress(OSError):
                os.close(fd)


def _write(fd: int, *pieces: bytes) -> None:
    for piece in pieces:
        rest = memoryview(piece)
        while rest:
            rest = rest[os.write(fd, rest) :]
