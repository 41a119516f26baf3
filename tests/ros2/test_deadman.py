"""The vehicle is told to stop 0.5 s after the last command, whatever the service is at."""

import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from service.ros.graph.graph import Lane, Message, Qos
from tests.ros2.support.links import POLL_S, Link
from tests.support.shared import PROJECT
from tests.support.waiting import until

pytestmark = pytest.mark.ros2

DRIVER = Path(__file__).with_name("support") / "driver.py"
SPEED_MPS = 1.5


class Vehicle:
    """What the vehicle of a driver hears."""

    def __init__(self, link: Link, driver: asyncio.subprocess.Process) -> None:
        self.driver = driver
        self.heard: list[tuple[float, float]] = []
        """When, s, and which speed, m/s."""
        link.node("vehicle", Lane.SENSORS).subscribe(
            "/cmd_vel", "geometry_msgs/msg/Twist", Qos.EVENTS, self._speed, self.heard.append
        )

    async def publisher(self) -> int:
        """Wait until the driver drives; return the process that publishes its commands."""
        assert self.driver.stdout is not None
        word, pid = (await self.driver.stdout.readline()).split()
        assert word == b"driving"
        await self.until_told(SPEED_MPS)
        return int(pid)

    def order(self, what: str) -> None:
        """Give the driver an order."""
        assert self.driver.stdin is not None
        self.driver.stdin.write(f"{what}\n".encode())

    async def until_told(self, speed_mps: float) -> float:
        """Wait until the vehicle is told this speed from now on, and return when."""
        known = len(self.heard)

        def found() -> list[float]:
            return [at for at, speed in self.heard[known:] if speed == speed_mps]

        await until(lambda: bool(found()), POLL_S)
        return found()[0]

    async def until_stopped(self) -> float:
        """Wait until the vehicle is told to stop; return for how long no command had come, s."""
        at = await self.until_told(0.0)
        return at - max(when for when, speed in self.heard if speed and when < at)

    @staticmethod
    def _speed(message: Message) -> tuple[float, float]:
        return time.monotonic(), float(message.linear.x)


@asynccontextmanager
async def vehicle(link: Link) -> AsyncIterator[Vehicle]:
    driver = await asyncio.create_subprocess_exec(
        sys.executable,
        # A module beside the driver has the name of a package of ours.
        "-P",
        str(DRIVER),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, "PYTHONPATH": str(PROJECT)},
    )
    try:
        yield Vehicle(link, driver)
    finally:
        if driver.returncode is None:
            driver.kill()
        await driver.communicate()


def runs(pid: int) -> bool:
    """Tell whether a process runs; one that ended and that nobody has waited for does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize("how", ["loop", "lock"])
async def test_it_is_stopped_while_the_service_stalls_and_driven_on_afterwards(
    link: Link, how: str
) -> None:
    async with vehicle(link) as robot:
        await robot.publisher()
        robot.order(how)

        # Half a second, what this machine adds, and less than the stall.
        assert 0.4 < await robot.until_stopped() < 1.5
        await robot.until_told(SPEED_MPS)


async def test_it_is_stopped_at_once_when_the_service_is_killed(link: Link) -> None:
    async with vehicle(link) as robot:
        publisher = await robot.publisher()
        robot.driver.kill()

        assert await robot.until_stopped() < 0.5
        await until(lambda: not runs(publisher), POLL_S)


async def test_it_is_stopped_while_the_service_is_suspended(link: Link) -> None:
    async with vehicle(link) as robot:
        await robot.publisher()
        robot.driver.send_signal(signal.SIGSTOP)

        assert 0.4 < await robot.until_stopped() < 1.5
        robot.driver.send_signal(signal.SIGCONT)
        await robot.until_told(SPEED_MPS)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
async def test_it_is_stopped_when_the_publishing_process_fails_and_driven_by_a_new_one(
    link: Link, how: signal.Signals
) -> None:
    async with vehicle(link) as robot:
        publisher = await robot.publisher()
        os.kill(publisher, how)

        assert await robot.until_stopped() < 2.0
        assert await robot.publisher() != publisher
        await until(lambda: not runs(publisher), POLL_S)


async def test_signals_to_all_processes_do_not_end_the_publishing_one_first(link: Link) -> None:
    async with vehicle(link) as robot:
        publisher = await robot.publisher()
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            os.kill(publisher, number)
        await robot.until_told(SPEED_MPS)
        robot.order("end")

        await robot.until_stopped()
        assert await robot.driver.wait() == 0
        await until(lambda: not runs(publisher), POLL_S)
