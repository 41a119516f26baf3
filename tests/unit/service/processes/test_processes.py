"""The programs of a robot: run as the core says, and never longer than the service."""

import asyncio
import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from domain.commands import StartProcess, StopProcess
from domain.process_terms import ProcessExit, ProcessReport
from domain.state_and_mode import PartName
from service.ports import BackendMessage
from service.processes.processes import LocalProcesses
from service.processes.program import ProgramSettings
from tests.support.shared import PROJECT
from tests.support.waiting import until

NODE, OTHER = PartName("drive_base"), PartName("arm")
PAUSE_S = 0.02
SLEEP = ("sh", "-c", "echo ready; exec sleep 100")


class Runner:
    """The programs of two nodes, and what they report."""

    def __init__(self, *command: str) -> None:
        settings = ProgramSettings(command, "/", stop_s=20.0)
        self.processes = LocalProcesses({NODE: settings, OTHER: settings})
        self.reports: list[BackendMessage] = []
        self.task = asyncio.create_task(self.processes.run(self.reports.append))

    async def report(self, number: int) -> ProcessReport:
        """Wait for a report, counted from 0, and return it."""
        await until(lambda: len(self.reports) > number, PAUSE_S)
        report = self.reports[number]
        assert isinstance(report, ProcessReport)
        return report

    async def close(self) -> None:
        self.task.cancel()
        await asyncio.wait([self.task])


@pytest.fixture
async def sleeping() -> AsyncIterator[Runner]:
    """Return a runner whose programs sleep."""
    runner = Runner(*SLEEP)
    await runner.report(1)
    yield runner
    await runner.close()


async def test_nothing_is_started_by_itself(sleeping: Runner) -> None:
    assert sleeping.reports == [ProcessReport(NODE), ProcessReport(OTHER)]


async def test_a_program_is_started_and_stopped(sleeping: Runner) -> None:
    sleeping.processes.send(StartProcess(NODE))
    pid = (await sleeping.report(2)).pid
    assert pid is not None
    assert os.getpgid(pid) == pid

    sleeping.processes.send(StopProcess(NODE))

    assert (await sleeping.report(3)).exit == ProcessExit(signal="SIGINT")
    sleeping.processes.send(StartProcess(NODE))
    assert (await sleeping.report(4)).pid not in (None, pid)


async def test_a_stop_that_comes_before_it_runs_ends_it_all_the_same(sleeping: Runner) -> None:
    sleeping.processes.send(StartProcess(NODE))
    await asyncio.sleep(0)
    sleeping.processes.send(StopProcess(NODE))

    assert (await sleeping.report(3)).exit is not None


async def test_what_it_printed_is_kept_with_its_end() -> None:
    runner = Runner("sh", "-c", "echo $((6 * 7)); exit 2")
    await runner.report(1)
    runner.processes.send(StartProcess(NODE))
    end = await runner.report(3)

    assert end == ProcessReport(NODE, exit=ProcessExit(2))
    output = runner.processes.output(NODE)
    assert (output.running, output.ended) == ([], ["42"])
    assert runner.processes.output(OTHER).ended == []
    await runner.close()


async def test_a_system_that_starts_no_process_is_told(
    sleeping: Runner, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def fail(*_: object, **__: object) -> None:
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(asyncio, "create_subprocess_exec", fail)
    sleeping.processes.send(StartProcess(NODE))

    end = (await sleeping.report(2)).exit
    assert end is not None
    assert end.words == "it could not be started: Resource temporarily unavailable"


async def test_all_end_with_the_service(sleeping: Runner) -> None:
    sleeping.processes.send(StartProcess(NODE))
    sleeping.processes.send(StartProcess(OTHER))
    pids = [(await sleeping.report(number)).pid for number in (2, 3)]

    await sleeping.close()

    assert not any(map(is_there, pids))


def is_there(pid: int | None) -> bool:
    return Path(f"/proc/{pid}").exists()


SERVICE = """
import asyncio
from domain.commands import StartProcess
from domain.state_and_mode import PartName
from service.processes.processes import LocalProcesses
from service.processes.program import ProgramSettings

node = PartName("n")
command = ("sh", "-c", "sleep 100 & echo $! > {file}.tmp; mv {file}.tmp {file}; wait")
processes = LocalProcesses({{node: ProgramSettings(command, "/")}})

def deliver(report):
    if report.pid is None:
        processes.send(StartProcess(node))

asyncio.run(processes.run(deliver))
"""


def started(program: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen([sys.executable, "-c", program], cwd=PROJECT)


async def test_nothing_outlives_a_service_that_is_killed(tmp_path: Path) -> None:
    file = tmp_path / "pid"
    program = textwrap.dedent(SERVICE.format(file=file))
    with started(program) as service:
        await until(file.exists, PAUSE_S)
        service.send_signal(signal.SIGKILL)
        await asyncio.to_thread(service.wait)

    left = Path(f"/proc/{file.read_text().strip()}/stat")
    await until(lambda: not left.exists() or ") Z " in left.read_text(), PAUSE_S)
