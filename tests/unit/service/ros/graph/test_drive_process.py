"""The process that commands a vehicle, with a program in its place that needs no ROS."""

import asyncio
import os
import signal
import socket
import sys
import textwrap
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from domain.vehicle import DriveCommand
from service.ros.graph import drive_process
from service.ros.graph.drive import RECORD
from service.ros.graph.drive_process import DriveProcess
from tests.support.waiting import until

PAUSE_S = 0.02
DRIVE = DriveCommand(1.5, 0.1)
CHILD = """
import socket, sys, time
channel = socket.socket(fileno=int(sys.argv[1]))
channel.settimeout(0.1)
file = open({file!r}, "ab", buffering=0)
while True:
    channel.send(b"alive")
    try:
        record = channel.recv(64)
    except TimeoutError:
        continue
    if not record:
        break
    file.write(record)
"""


class Output:
    def __init__(self, received: Path) -> None:
        self.received = received
        self.stops: list[DriveCommand] = []
        self.process = DriveProcess("/cmd_vel", "geometry_msgs/msg/Twist", 2.0, self.stops.append)
        self.told: list[str] = []
        """The troubles, in order; empty texts for none."""
        self.running = asyncio.create_task(self.process.run(self._changed))

    async def until_it_works(self) -> int:
        await until(lambda: not self.process.trouble, PAUSE_S)
        assert self.process.pid is not None
        return self.process.pid

    def _changed(self) -> None:
        self.told.append(self.process.trouble)

    def commands(self) -> list[DriveCommand]:
        data = self.received.read_bytes()
        return [DriveCommand(speed, angle) for _, speed, angle in RECORD.iter_unpack(data)]


@pytest.fixture
async def output(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Output]:
    received = tmp_path / "received"
    code = textwrap.dedent(CHILD).format(file=str(received))

    async def start(
        channel: socket.socket, _arguments: tuple[str, ...]
    ) -> asyncio.subprocess.Process:
        number = channel.fileno()
        return await asyncio.create_subprocess_exec(
            sys.executable, "-c", code, str(number), pass_fds=(number,)
        )

    monkeypatch.setattr(drive_process, "_start", start)
    made = Output(received)
    yield made
    made.running.cancel()
    await asyncio.wait([made.running])


async def test_commands_are_passed_on(output: Output) -> None:
    await output.until_it_works()
    output.process.send(DRIVE)

    await until(lambda: output.commands() == [DRIVE], PAUSE_S)


async def test_a_command_before_the_start_is_lost_and_the_output_says_so(output: Output) -> None:
    assert output.process.trouble == "the drive process is starting"
    output.process.send(DRIVE)
    await output.until_it_works()

    assert output.commands() == []


@pytest.mark.parametrize(
    ("how", "why"),
    [
        (signal.SIGKILL, "the drive process has ended, and is started again"),
        (signal.SIGSTOP, "the drive process has said nothing for 1 s, and is started again"),
    ],
)
async def test_a_process_that_fails_is_replaced_and_the_vehicle_stopped_from_here(
    output: Output, how: signal.Signals, why: str
) -> None:
    first = await output.until_it_works()
    output.process.send(DRIVE)
    os.kill(first, how)
    await until(lambda: bool(output.process.trouble), PAUSE_S)

    assert output.stops == [DriveCommand(0.0, 0.1)]
    assert await output.until_it_works() != first
    assert output.told == ["", why, ""]


async def test_a_process_that_cannot_be_started_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    async def start(
        channel: socket.socket, arguments: tuple[str, ...]
    ) -> asyncio.subprocess.Process:
        raise OSError("no more processes")

    monkeypatch.setattr(drive_process, "_start", start)
    process = DriveProcess("/cmd_vel", "geometry_msgs/msg/Twist", 2.0, lambda _: None)
    told: list[str] = []
    running = asyncio.create_task(process.run(lambda: told.append(process.trouble)))
    await until(lambda: bool(told), PAUSE_S)
    running.cancel()
    await asyncio.wait([running])

    assert told == ["the drive process cannot be started: no more processes"]


async def test_a_vehicle_that_stands_is_not_told_again(output: Output) -> None:
    first = await output.until_it_works()
    output.process.send(DriveCommand(0.0, 0.0))
    os.kill(first, signal.SIGKILL)
    await until(lambda: bool(output.process.trouble), PAUSE_S)

    assert output.stops == []


async def test_a_process_that_does_not_read_holds_up_nobody(output: Output) -> None:
    os.kill(await output.until_it_works(), signal.SIGSTOP)

    for _ in range(10_000):
        output.process.send(DRIVE)


async def test_the_process_ends_with_us(output: Output) -> None:
    pid = await output.until_it_works()
    output.running.cancel()
    await asyncio.wait([output.running])

    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)
