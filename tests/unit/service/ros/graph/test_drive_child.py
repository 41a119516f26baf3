import asyncio
import socket
from collections.abc import AsyncIterator

import pytest

from domain.timebase import seconds
from domain.vehicle import DriveCommand
from service.ros.graph.drive import RECORD
from service.ros.graph.drive_child import DriveChild
from tests.support.manual_clock import ManualClock
from tests.support.waiting import until

DRIVE, STOP = DriveCommand(1.5, 0.1), DriveCommand(0.0, 0.1)


class Child:
    """A child in this process, and the other end of its channel."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.published: list[DriveCommand] = []
        self.service, channel = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        channel.setblocking(False)
        self.channel = channel
        child = DriveChild(channel, self.published.append, self.clock)
        self.running = asyncio.create_task(child.run())

    def send(self, command: DriveCommand, ago_s: float = 0.0) -> None:
        sent_at = self.clock.now() - seconds(ago_s)
        record = RECORD.pack(sent_at, command.speed_mps, command.steering_angle_rad)
        self.service.send(record)

    async def until_published(self, *commands: DriveCommand) -> None:
        await until(lambda: len(self.published) >= len(commands))
        assert self.published == [*commands]


@pytest.fixture
async def child() -> AsyncIterator[Child]:
    made = Child()
    yield made
    made.service.close()
    await made.running
    made.channel.close()


async def test_a_command_is_published(child: Child) -> None:
    child.send(DRIVE)

    await child.until_published(DRIVE)


async def test_a_command_that_waited_while_it_was_suspended_is_not(child: Child) -> None:
    child.send(DRIVE, ago_s=0.6)
    child.send(STOP, ago_s=0.6)

    await child.until_published(STOP)


async def test_a_command_that_is_as_good_as_void_is_followed_by_a_stop(child: Child) -> None:
    child.send(DRIVE, ago_s=0.499)
    await child.until_published(DRIVE)
    await child.clock.advance(0.01)

    await until(lambda: len(child.published) > 1)
    assert child.published[1] == STOP


async def test_a_service_that_is_gone_is_the_end_and_the_vehicle_is_stopped_before(
    child: Child,
) -> None:
    child.send(DRIVE)
    await child.until_published(DRIVE)
    child.service.close()
    await child.running

    assert child.published == [DRIVE, STOP]


async def test_a_vehicle_that_nobody_drives_is_left_alone_at_the_end(child: Child) -> None:
    child.service.close()
    await child.running

    assert child.published == []


async def test_it_says_that_it_works(child: Child) -> None:
    assert await asyncio.to_thread(child.service.recv, 64) == b"alive"
