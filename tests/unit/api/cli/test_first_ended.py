import asyncio

import pytest

from api.cli.first_ended import until_first_ends


async def test_the_first_that_fails_ends_the_others_and_is_told_alone() -> None:
    ended = asyncio.Event()

    async def wait() -> None:
        try:
            await asyncio.Event().wait()
        finally:
            ended.set()

    async def fail() -> None:
        raise ValueError("gone")

    with pytest.raises(ValueError, match="gone"):
        await until_first_ends(wait(), fail())
    assert ended.is_set()


async def test_the_first_that_is_done_ends_the_others() -> None:
    async def wait() -> None:
        await asyncio.Event().wait()

    async def finish() -> None:
        return

    await until_first_ends(wait(), finish())


async def test_when_it_is_canceled_so_are_they() -> None:
    began, ended = asyncio.Event(), asyncio.Event()

    async def wait() -> None:
        began.set()
        try:
            await asyncio.Event().wait()
        finally:
            ended.set()

    task = asyncio.create_task(until_first_ends(wait()))
    await began.wait()
    task.cancel()

    with pytest.raises(asyncio.CancelledError):
        await task
    assert ended.is_set()
