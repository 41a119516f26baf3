"""The process that ends the programs of nodes with the service, also where that is killed."""

import asyncio
import logging
import os
import sys
from asyncio.subprocess import DEVNULL, Process
from contextlib import suppress
from pathlib import Path

_CHILD = Path(__file__).with_name("guard_child.py")
ISOLATED = ("-I", "-S")
"""The standard library, without what the environment or a site adds to it."""

log = logging.getLogger(__name__)


class Guard:
    """Knows the process groups of all programs; ends those that outlive the service."""

    def __init__(self) -> None:
        self._pipe: int | None = None
        self._process: Process | None = None
        self._groups: set[int] = set()

    async def pipe(self) -> int:
        """Return the pipe to the guard, which a program inherits; start the guard if needed.

        Raises:
            OSError: It cannot be started.
        """
        if self._pipe is None or self._process is None or self._process.returncode is not None:
            await self._start()
        assert self._pipe is not None
        return self._pipe

    def note_started(self, group: int) -> None:
        """Note a program; it told the guard itself."""
        self._groups.add(group)

    def note_ended(self, group: int) -> None:
        """Note that nothing of a program is left."""
        self._groups.discard(group)
        self._tell(f"-{group}\n")

    async def close(self) -> None:
        """Let the guard end; it ends what is left."""
        if self._pipe is not None:
            os.close(self._pipe)
            self._pipe = None
        if self._process is not None:
            await self._process.wait()

    async def _start(self) -> None:
        if self._pipe is not None:
            log.error("the process that ends programs with the service has ended; it starts again")
            os.close(self._pipe)
            self._pipe = None
        theirs, ours = os.pipe()
        try:
            self._process = await asyncio.create_subprocess_exec(
                sys.executable,
                *ISOLATED,
                str(_CHILD),
                stdin=theirs,
                stdout=DEVNULL,
                # It outlives the service, and what stops that is not meant for it.
                start_new_session=True,
            )
        except OSError:
            os.close(ours)
            raise
        finally:
            os.close(theirs)
        # A guard that does not read must not hold up the service.
        os.set_blocking(ours, False)
        self._pipe = ours
        for group in self._groups:
            self._tell(f"+{group}\n")

    def _tell(self, line: str) -> None:
        if self._pipe is not None:
            # A guard that has ended is started again with the next program.
            with suppress(BrokenPipeError, BlockingIOError):
                os.write(self._pipe, line.encode())
