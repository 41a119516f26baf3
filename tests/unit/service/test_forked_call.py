"""A function that reads the state of the process as it was at one moment."""

import asyncio
import os
import time

import pytest

from service.forked_call import ForkedCallError, forked_call


async def test_what_changes_meanwhile_is_not_seen() -> None:
    state = ["before"]
    call = asyncio.ensure_future(forked_call(lambda: ",".join(state).encode()))
    await asyncio.sleep(0)
    state.append("after")
    assert await call == b"before"


async def test_a_large_result_comes_whole() -> None:
    assert await forked_call(lambda: bytes(3_000_000)) == bytes(3_000_000)


async def test_an_empty_result_is_a_result() -> None:
    assert await forked_call(lambda: b"") == b""


async def test_why_a_function_failed_is_told() -> None:
    def fail() -> bytes:
        raise ValueError("no such robot")

    with pytest.raises(ForkedCallError, match="no such robot"):
        await forked_call(fail)


async def test_a_process_that_is_killed_gives_no_result() -> None:
    def die() -> bytes:
        os.kill(os.getpid(), 9)
        return b""

    with pytest.raises(ForkedCallError, match="was ended"):
        await forked_call(die)


async def test_no_file_of_this_process_stays_open_in_the_other() -> None:
    ours, _ = os.pipe()

    def opened() -> bytes:
        return b"open" if os.path.exists(f"/proc/self/fd/{ours}") else b"closed"

    assert await forked_call(opened) == b"closed"


async def test_a_call_that_is_given_up_leaves_no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    forks: list[int] = []

    def note() -> int:
        forks.append(child := fork())
        return child

    fork = os.fork
    monkeypatch.setattr(os, "fork", note)

    def sleep() -> bytes:
        time.sleep(60)
        return b""

    with pytest.raises(TimeoutError):
        await asyncio.wait_for(forked_call(sleep), 0.1)
    with pytest.raises(ProcessLookupError):
        os.kill(forks[0], 0)


async def test_a_process_that_cannot_be_forked_leaves_no_pipe(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refuse() -> int:
        raise BlockingIOError("too many processes")

    monkeypatch.setattr(os, "fork", refuse)
    before = os.listdir("/proc/self/fd")
    with pytest.raises(OSError, match="too many"):
        await forked_call(lambda: b"")
    assert os.listdir("/proc/self/fd") == before
