"""A service of one's own to measure: in a process of its own, on a free port, all simulated."""

import asyncio
import os
import re
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager, suppress
from pathlib import Path

from api.access_token import FILE_VARIABLE, TOKEN_VARIABLE

_ADDRESS = re.compile(r"^  page  (http://\S+)/$")
_CODE = """\
import sys
from api.profiling.end_with_parent import end_with_parent
end_with_parent()
from api.cli.command_line import main
sys.exit(main())
"""
_START_S = 30.0
_END_S = 10.0
_NOT_INHERITED = frozenset({TOKEN_VARIABLE, FILE_VARIABLE, "NOTIFY_SOCKET", "WATCHDOG_USEC"})
"""Nobody else is to use it; and to a service manager, the command itself may be the service."""


class NotServingError(Exception):
    """The service did not start; the message has what it said."""


@asynccontextmanager
async def own_service(options: Sequence[str], log: Path) -> AsyncIterator[str]:
    """Run a service as long as the context lasts; return its URL.

    Args:
        options: More options of `pilothouse serve`.
        log: File for its log.

    Raises:
        NotServingError: It did not start.
        OSError: The log cannot be written, or no process be started.
    """
    with log.open("wb") as complaints:
        process = await _start(options, complaints.fileno())
        try:
            url = await _address_of(process)
            if url is None:
                raise NotServingError(f"the service did not start:\n{_said(log)}")
            yield url
        finally:
            await _end(process)


async def _start(options: Sequence[str], log: int) -> Process:
    path = os.pathsep.join(entry or os.getcwd() for entry in sys.path)
    inherited = {name: value for name, value in os.environ.items() if name not in _NOT_INHERITED}
    return await asyncio.create_subprocess_exec(
        sys.executable,
        "-P",
        "-c",
        _CODE,
        "serve",
        "--backend",
        "simulated",
        "--port",
        "0",
        *options,
        stdin=PIPE,
        stdout=PIPE,
        stderr=log,
        env={**inherited, "PYTHONPATH": path},
        # Ctrl-C is for the command, which ends the service once it has kept what was measured.
        process_group=0,
    )


async def _address_of(process: Process) -> str | None:
    """Return the URL that a service prints when it listens; None: it ended.

    Raises:
        NotServingError: It took too long.
    """
    assert process.stdout is not None
    try:
        async with asyncio.timeout(_START_S):
            async for line in process.stdout:
                if found := _ADDRESS.match(line.decode().rstrip("\n")):
                    return found.group(1)
    except TimeoutError as error:
        raise NotServingError(f"the service did not start within {_START_S:g} s") from error
    return None


def _said(log: Path) -> str:
    return log.read_text(encoding="utf-8", errors="replace").strip()


async def _end(process: Process) -> None:
    """End a service, at the latest after `_END_S`."""
    with suppress(ProcessLookupError):
        process.terminate()
    try:
        async with asyncio.timeout(_END_S):
            await process.wait()
    except TimeoutError:
        with suppress(ProcessLookupError):
            process.kill()
        await process.wait()
