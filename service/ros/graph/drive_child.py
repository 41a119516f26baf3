"""The process that commands the vehicle: publishes what the service sends, else speed 0.

It ends with the service, however that ends, and commands speed 0 first: its channel is closed then.
A service manager that signals all processes at once does not end it before.
"""

import asyncio
import signal
import socket
import sys
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

from domain.timebase import Instant, to_seconds
from domain.vehicle import COMMAND_VALID_FOR, DriveCommand
from service.clock import Clock, MonotonicClock
from service.ros.graph.drive import RECORD, Deadman, drive_message

SPEAK_EVERY_S = 0.2
"""The service kills a process that is silent for 1 s."""

_SENT_S = 0.2
"""The middleware sends the last message in a thread of its own."""
_ALIVE = b"alive"


class DriveChild:
    """Publishes the commands of a channel."""

    def __init__(
        self, channel: socket.socket, publish: Callable[[DriveCommand], None], clock: Clock
    ) -> None:
        """Prepare.

        Args:
            channel: From the service, not blocking; one record is one command.
            publish: Publishes a command, and returns at once.
            clock: The one that the service uses.
        """
        self._channel = channel
        self._publish = publish
        self._clock = clock
        self._deadman = Deadman()
        self._ended = asyncio.Event()
        self._commanded = asyncio.Event()

    async def run(self) -> None:
        """Work until the service ends or closes the channel, and command speed 0 then."""
        loop = asyncio.get_running_loop()
        loop.add_reader(self._channel, self._hear)
        working = [asyncio.create_task(self._watch()), asyncio.create_task(self._speak())]
        await self._ended.wait()
        loop.remove_reader(self._channel)
        for task in working:
            task.cancel()
        if self._deadman.wake_at() is not None:
            self._publish(self._deadman.stop())

    def _hear(self) -> None:
        """Take what has arrived; of several commands the newest counts."""
        newest: tuple[Instant, DriveCommand] | None = None
        while (record := self._next()) is not None:
            sent_at, speed_mps, steering_angle_rad = RECORD.unpack(record)
            newest = sent_at, DriveCommand(speed_mps, steering_angle_rad)
        if newest is None:
            return
        sent_at, command = newest
        # Else it was sent long ago, while this process was stopped.
        if self._clock.now() - sent_at < COMMAND_VALID_FOR or command.speed_mps == 0.0:
            self._publish(command)
            self._deadman.take(command, sent_at)
            self._commanded.set()

    def _next(self) -> bytes | None:
        try:
            record = self._channel.recv(RECORD.size)
        except BlockingIOError:
            return None
        except ConnectionError:
            record = b""
        if not record:
            self._ended.set()
            return None
        return record

    async def _watch(self) -> None:
        """Command speed 0 whenever that is due."""
        while True:
            due = self._deadman.wake_at()
            self._commanded.clear()
            left_s = None if due is None else max(to_seconds(due - self._clock.now()), 0.0)
            with suppress(TimeoutError):
                async with asyncio.timeout(left_s):
                    await self._commanded.wait()
            stop = self._deadman.advance(self._clock.now())
            if stop is not None:
                self._publish(stop)

    async def _speak(self) -> None:
        """Tell the service that this process works."""
        while True:
            with suppress(OSError):
                self._channel.send(_ALIVE)
            await asyncio.sleep(SPEAK_EVERY_S)


class _Arguments(NamedTuple):
    """The arguments of the process, after the number of its channel."""

    topic: str
    type_name: str
    wheelbase_m: str
    node: str


async def _work(channel: socket.socket, arguments: _Arguments) -> None:
    # Imported here, since the rest of this module needs no ROS.
    from service.ros.graph.graph import Lane, Qos
    from service.ros.graph.link import RosLink

    topic, type_name, wheelbase_m, node = arguments
    link = RosLink()
    publisher = link.node(node, Lane.SENSORS).publisher(topic, type_name, Qos.COMMANDS)

    def publish(command: DriveCommand) -> None:
        publisher.publish(drive_message(command, type_name, float(wheelbase_m)))

    await DriveChild(channel, publish, MonotonicClock()).run()
    await asyncio.sleep(_SENT_S)
    await link.close()


def main() -> None:
    """Run; the arguments are the number of the channel, and what `_Arguments` names."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT"):
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    number, *rest = sys.argv[1:]
    with socket.socket(fileno=int(number)) as channel:
        channel.setblocking(False)
        asyncio.run(_work(channel, _Arguments(*rest)))
