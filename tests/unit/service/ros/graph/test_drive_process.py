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
        self.running = asyncio.create_task(self.process.run())

    async def until_it_works(self) -> int:
        await until(lambda: self.process.works, PAUSE_S)
        assert self.process.pid is not None
        return self.process.pid

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
    assert not output.process.works
    output.process.send(DRIVE)
    await output.until_it_works()

    assert output.commands() == []


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
async def test_a_process_that_fails_is_replaced_and_the_vehicle_stopped_from_here(
    output: Output, how: signal.Signals
) -> None:
    first = await output.until_it_works()
    output.process.send(DRIVE)
    os.kill(first, how)
    await until(lambda: not output.process.works, PAUSE_S)

    assert output.stops == [DriveCommand(0.0, 0.1)]
    assert await output.until_it_works() != first


async def test_a_vehicle_that_stands_is_not_told_again(output: Output) -> None:
    first = await output.until_it_works()
    output.process.send(DriveCommand(0.0, 0.0))
    os.kill(first, signal.SIGKILL)
    await until(lambda: not output.process.works, PAUSE_S)

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
