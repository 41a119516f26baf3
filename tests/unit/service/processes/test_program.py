"""One program: started without a shell, read, and ended with all that it started."""

import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from domain.process_terms import ProcessExit
from service.processes.guard import Guard
from service.processes.output_tail import OutputTail
from service.processes.program import Program, ProgramSettings
from tests.support.waiting import until

PAUSE_S = 0.02
STUBBORN = "trap '' INT TERM; echo ready; while true; do sleep 0.05; done"
LONG_S = 30.0


@pytest.fixture
async def guard() -> AsyncIterator[Guard]:
    guard = Guard()
    yield guard
    await guard.close()


class Started:
    """A program of these tests."""

    def __init__(self, program: Program, tail: OutputTail) -> None:
        self.program = program
        self._tail = tail

    @property
    def output(self) -> list[str]:
        return self._tail.lines()

    async def until_ready(self) -> None:
        await until(lambda: "ready" in self.output, PAUSE_S)


async def start(
    guard: Guard, *command: str, folder: Path | str = "/", stop_s: float = LONG_S, **more: str
) -> Started:
    tail = OutputTail()
    settings = ProgramSettings(command, str(folder), more, stop_s)
    return Started(await Program.start(settings, guard, tail), tail)


async def test_a_program_prints_and_ends_with_its_code(guard: Guard) -> None:
    started = await start(guard, "sh", "-c", "echo out; echo err >&2; exit 3")

    assert await started.program.ended() == ProcessExit(3)
    assert started.output == ["out", "err"]


async def test_no_shell_reads_its_arguments(guard: Guard) -> None:
    started = await start(guard, "printf", "%s\n", "$HOME; *", "a  b")

    await started.program.ended()

    assert started.output == ["$HOME; *", "a  b"]


async def test_it_has_its_folder_and_its_environment(guard: Guard, tmp_path: Path) -> None:
    started = await start(guard, "sh", "-c", "pwd; echo $COLOUR", folder=tmp_path, COLOUR="red")

    await started.program.ended()

    assert started.output == [str(tmp_path), "red"]


async def test_a_program_beside_the_robot_file_is_found(guard: Guard, tmp_path: Path) -> None:
    (tmp_path / "node.sh").write_text("#!/bin/sh\necho here\n")
    (tmp_path / "node.sh").chmod(0o755)
    started = await start(guard, "./node.sh", folder=tmp_path)

    await started.program.ended()

    assert started.output == ["here"]


@pytest.mark.parametrize(
    ("command", "folder", "code", "words"),
    [
        ("no-such-program", "/", 127, "cannot run no-such-program: No such file"),
        ("/etc/passwd", "/", 126, "cannot run /etc/passwd: Permission denied"),
        ("true", "/no/such/folder", 127, "cannot run /no/such/folder: No such file"),
    ],
)
async def test_what_cannot_be_run_says_why(
    command: str, folder: str, code: int, words: str, guard: Guard
) -> None:
    started = await start(guard, command, folder=folder)
    end = await started.program.ended()

    assert end.code == code
    assert end.words.startswith(f"exit code {code}: the command")
    assert words in started.output[0]


async def test_the_signal_that_ended_it_is_named(guard: Guard) -> None:
    started = await start(guard, "sh", "-c", "kill -SEGV $$")

    assert await started.program.ended() == ProcessExit(signal="SIGSEGV")


async def test_it_ignores_no_signals_that_python_does(guard: Guard) -> None:
    started = await start(guard, "grep", "SigIgn", "/proc/self/status")

    await started.program.ended()

    assert int(started.output[0].split()[1], 16) & (1 << (signal.SIGPIPE - 1)) == 0


async def test_it_is_asked_to_end_as_with_ctrl_c(guard: Guard) -> None:
    polite = "trap 'echo bye; exit 0' INT; echo ready; while true; do sleep 0.05; done"
    started = await start(guard, "sh", "-c", polite)
    await started.until_ready()

    assert await started.program.stop() == ProcessExit(0)
    assert started.output == ["ready", "bye"]


async def test_one_that_knows_only_sigterm_gets_that(guard: Guard) -> None:
    deaf = "trap '' INT; trap 'exit 7' TERM; echo ready; while true; do sleep 0.05; done"
    started = await start(guard, "sh", "-c", deaf, stop_s=0.4)
    await started.until_ready()

    assert await started.program.stop() in (ProcessExit(7), ProcessExit(signal="SIGKILL"))


async def test_one_that_does_not_end_is_killed(guard: Guard) -> None:
    started = await start(guard, "sh", "-c", STUBBORN, stop_s=0.1)
    await started.until_ready()

    assert await started.program.stop() == ProcessExit(signal="SIGKILL")


async def test_what_a_program_leaves_behind_ends_with_it(guard: Guard) -> None:
    started = await start(guard, "sh", "-c", "sleep 100 & echo $!; exit 1")
    end = await started.program.ended()
    (left,) = started.output

    assert end == ProcessExit(1)
    await until(lambda: not is_alive(int(left)), PAUSE_S)


async def test_a_program_that_prints_without_end_lets_others_work(guard: Guard) -> None:
    started = await start(guard, "yes", "ready")
    await started.until_ready()

    async with asyncio.timeout(LONG_S):
        for _ in range(100):
            await asyncio.sleep(0)
        await started.program.stop()

    assert started.output == ["ready"] * 200


def test_its_environment_is_not_shown() -> None:
    settings = ProgramSettings((sys.executable,), "/", {"TOKEN": "hush"})

    assert "hush" not in repr(settings)


def is_alive(pid: int) -> bool:
    """Tell whether a process runs; one that only waits to be reaped does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_a_process_is_known_to_be_alive() -> None:
    assert is_alive(os.getpid())
