"""The guard, as the service sees it."""

import asyncio
import os
import signal
import subprocess
from pathlib import Path

import pytest

from service.processes.guard import Guard
from tests.support.waiting import until

PAUSE_S = 0.02


def children() -> set[int]:
    text = Path(f"/proc/self/task/{os.getpid()}/children").read_text()
    return set(map(int, text.split()))


def sleeping() -> subprocess.Popen[bytes]:
    return subprocess.Popen(["sleep", "100"], start_new_session=True)


async def test_it_is_started_once_and_ends_when_it_is_closed() -> None:
    before, guard = children(), Guard()
    pipe = await guard.pipe()
    assert await guard.pipe() == pipe
    assert len(children() - before) == 1

    await guard.close()

    assert children() <= before


async def test_one_that_was_killed_is_replaced_and_knows_all_groups(
    caplog: pytest.LogCaptureFixture,
) -> None:
    before, guard = children(), Guard()
    await guard.pipe()
    (first,) = children() - before
    with sleeping() as program:
        guard.note_started(program.pid)
        os.kill(first, signal.SIGKILL)
        await until(lambda: first not in children(), PAUSE_S)
        guard.note_ended(999_999_999)

        # The loop is told of an end a moment after it.
        while "has ended; it starts again" not in caplog.text:
            await guard.pipe()
            await asyncio.sleep(PAUSE_S)
        await guard.close()

        assert await asyncio.to_thread(program.wait, 20) == -signal.SIGINT


async def test_one_that_never_started_is_closed_as_well() -> None:
    guard = Guard()
    guard.note_ended(1_000_000)

    await guard.close()
