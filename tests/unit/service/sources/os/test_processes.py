"""Processes of a name; those of this test are real."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import psutil
import pytest

from service.sources.os import processes
from service.sources.os.processes import Processes, comm_of
from service.sources.os.rates import Rate
from service.sources.source import SourceError

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")

NAME = f"a camera driver {os.getpid()}"
"""Longer than the kernel keeps; and not that of another run of these tests."""


@pytest.fixture
def _two(tmp_path: Path) -> Iterator[None]:
    """Run two processes of the name."""
    program = tmp_path / NAME
    program.symlink_to("/bin/sleep")
    running = [subprocess.Popen((str(program), "60")) for _ in range(2)]
    while any(psutil.Process(process.pid).name() != NAME for process in running):
        time.sleep(0.01)
    yield
    for process in running:
        process.kill()
        process.wait()


@pytest.mark.usefixtures("_two")
def test_what_several_processes_of_a_name_use_is_added_up() -> None:
    found = Processes(NAME)

    assert found.reader("processes")() == 2
    assert found.reader("threads")() == 2
    files, memory = found.reader("open_files")(), found.reader("memory_bytes")()
    assert files is not None
    assert files >= 2
    assert memory is not None
    assert 0 < memory < 50e6
    share = found.reader("memory_percent")()
    assert share == pytest.approx(100 * memory / psutil.virtual_memory().total, rel=0.5)


def test_none_is_a_number_of_processes_but_no_memory() -> None:
    none = Processes("no such process")

    assert none.reader("processes")() == 0
    with pytest.raises(SourceError, match="no process is named no such process"):
        none.reader("memory_bytes")()


@pytest.mark.usefixtures("_two")
def test_the_cpu_time_of_a_process_that_restarted_is_not_taken_for_a_burst(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    used = dict.fromkeys((process.pid for process in Processes(NAME).found()), 10.0)
    monkeypatch.setattr(processes, "_cpu_s", lambda process: used[process.pid])
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    clock = SimpleNamespace(now=0.0)
    monkeypatch.setattr(processes, "Rate", lambda: Rate(lambda: clock.now))
    read = Processes(NAME).reader("cpu_percent")
    assert read() is None

    clock.now = 1.0
    for pid in used:
        used[pid] += 0.5
    assert read() == 50.0


@pytest.mark.usefixtures("_two")
def test_a_process_of_another_user_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def denied(process: psutil.Process) -> float:
        raise psutil.AccessDenied(process.pid)

    monkeypatch.setattr(processes, "_pss", denied)
    with pytest.raises(SourceError, match="belongs to another user"):
        Processes(NAME).reader("memory_bytes")()


@pytest.mark.usefixtures("_two")
def test_a_process_that_ends_meanwhile_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    first = min(process.pid for process in Processes(NAME).found())

    def pss(process: psutil.Process) -> float:
        if process.pid == first:
            raise psutil.NoSuchProcess(process.pid)
        return 5.0

    monkeypatch.setattr(processes, "_pss", pss)
    assert Processes(NAME).reader("memory_bytes")() == 5.0


def test_a_process_that_ended_and_nobody_asked_how_does_not_count(tmp_path: Path) -> None:
    program = tmp_path / f"short{os.getpid()}"
    program.symlink_to("/bin/true")
    ended = subprocess.Popen((str(program),))
    while psutil.Process(ended.pid).status() != psutil.STATUS_ZOMBIE:
        time.sleep(0.01)

    assert Processes(program.name).reader("processes")() == 0
    ended.wait()


def test_the_name_of_a_process_that_ended_is_empty() -> None:
    ended = subprocess.Popen(("true",))
    ended.wait()

    assert comm_of(ended.pid) == ""
    assert comm_of(os.getpid())
