"""The process that commands the vehicle, as the service sees it.

The service sends each command to it, and it alone publishes them. What makes the vehicle stop when
no command comes does therefore not depend on the event loop, nor on the interpreter lock of the
service. It is started again whenever it ends, and killed if it is silent.
"""

import asyncio
import logging
import os
import socket
import sys
from asyncio.subprocess import DEVNULL, Process
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager, suppress
from dataclasses import replace

from domain.vehicle import DriveCommand
from service.clock import Clock, MonotonicClock
from service.ros.graph.drive import RECORD

SILENT_S = 1.0
"""A process that says nothing for so long hangs; it speaks five times a second."""

_START_S = 20.0
_RESTART_S = 0.2
_END_S = 1.0
_WORD_BYTES = 64

log = logging.getLogger(__name__)


class DriveProcess:
    """A `DriveOutput` in a process of its own."""

    def __init__(
        self,
        topic: str,
        type_name: str,
        wheelbase_m: float,
        publish: Callable[[DriveCommand], None],
        clock: Clock | None = None,
        node: str = "pilothouse_drive",
    ) -> None:
        """Prepare; `run` starts the process.

        Args:
            topic: Full name.
            type_name: Of its messages.
            wheelbase_m: Of the vehicle, m.
            publish: Publishes a command from here, past the process; for a stop when it ended.
            clock: Monotonic and the same in all processes of this machine; None: that of Linux.
            node: Name of the node in the process.
        """
        self._arguments = (topic, type_name, repr(wheelbase_m), node)
        self._publish = publish
        self._clock = clock or MonotonicClock()
        self._channel: socket.socket | None = None
        self._told = DriveCommand(0.0, 0.0)
        self._changed: Callable[[], None] = _nobody
        self.trouble = "the drive process is starting"
        """Why commands do not reach the topic; empty: they do."""
        self.pid: int | None = None
        """Number of the process while it works."""

    def send(self, command: DriveCommand) -> None:
        """Pass a command on, and return at once; while the process does not work, it is lost."""
        self._told = command
        if self._channel is None:
            return
        record = RECORD.pack(self._clock.now(), command.speed_mps, command.steering_angle_rad)
        # The reader of the channel notices both: a process that is gone, and one that hangs.
        with suppress(BlockingIOError, ConnectionError):
            self._channel.send(record)

    async def run(self, changed: Callable[[], None]) -> None:
        """Keep the process running until cancelled; then it stops the vehicle and ends.

        Args:
            changed: Called whenever `trouble` changed.
        """
        self._changed = changed
        while True:
            try:
                async with self._started() as channel:
                    await self._attend(channel)
            except OSError as error:
                log.error("the drive process cannot be started: %s", error)
                self._tell(f"the drive process cannot be started: {error}")
            await asyncio.sleep(_RESTART_S)

    def _tell(self, trouble: str) -> None:
        if trouble != self.trouble:
            self.trouble = trouble
            self._changed()

    @asynccontextmanager
    async def _started(self) -> AsyncIterator[socket.socket]:
        """Start the process, and end it with the context."""
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with ours, theirs:
            ours.setblocking(False)
            process = await _start(theirs, self._arguments)
            theirs.close()
            self.pid = process.pid
            try:
                yield ours
            finally:
                self.pid = self._channel = None
                ours.close()
                await _end(process)

    async def _attend(self, channel: socket.socket) -> None:
        """Listen to the process until it ends or is silent, and stop the vehicle then."""
        within_s = _START_S
        while not (why := await _silence(channel, within_s)):
            self._channel, within_s = channel, SILENT_S
            self._tell("")
        log.error("the drive process %s; it is started again", why)
        if self._told.speed_mps != 0.0:
            self._told = replace(self._told, speed_mps=0.0)
            self._publish(self._told)
        self._tell(f"the drive process {why}, and is started again")


async def _start(channel: socket.socket, arguments: tuple[str, ...]) -> Process:
    path = os.pathsep.join(entry or os.getcwd() for entry in sys.path)
    return await asyncio.create_subprocess_exec(
        sys.executable,
        "-P",
        "-c",
        "from service.ros.graph.drive_child import main; main()",
        str(channel.fileno()),
        *arguments,
        stdin=DEVNULL,
        stdout=DEVNULL,
        env={**os.environ, "PYTHONPATH": path},
        pass_fds=(channel.fileno(),),
        # Ctrl-C is for the service, which then tells it.
        start_new_session=True,
    )


async def _end(process: Process) -> None:
    """Let the process end, since its channel is closed; kill it if it does not."""
    try:
        async with asyncio.timeout(_END_S):
            await process.wait()
    except TimeoutError:
        process.kill()
        await process.wait()


async def _silence(channel: socket.socket, within_s: float) -> str:
    """Wait for the next word of the process; return why there is none, or nothing."""
    try:
        async with asyncio.timeout(within_s):
            heard = await asyncio.get_running_loop().sock_recv(channel, _WORD_BYTES)
    except TimeoutError:
        # After a stall of our own, what it said meanwhile is there.
        try:
            heard = channel.recv(_WORD_BYTES)
        except BlockingIOError:
            return f"has said nothing for {within_s:g} s"
        except OSError:
            heard = b""
    except ConnectionError:
        heard = b""
    return "" if heard else "has ended"


def _nobody() -> None:
    """Nobody is told before the process runs."""
