import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

import pytest

from service.running import TaskFailedError, run_forever


async def fail() -> None:
    raise OSError("no such bus")


async def rest() -> None:
    await asyncio.Event().wait()


async def end() -> None:
    return


@pytest.mark.parametrize(("ends", "cause"), [(fail, "no such bus"), (end, "None")])
async def test_the_first_task_that_ends_ends_the_others_and_is_named(
    ends: Callable[[], Coroutine[Any, Any, None]], cause: str
) -> None:
    with pytest.raises(ExceptionGroup) as raised:
        await run_forever({"robot": ends(), "tick": rest()})

    (error,) = raised.value.exceptions
    assert isinstance(error, TaskFailedError)
    assert (error.name, str(error.__cause__)) == ("robot", cause)


async def test_all_end_when_it_is_cancelled() -> None:
    run = asyncio.create_task(run_forever({"robot": rest(), "tick": rest()}))
    await asyncio.sleep(0)
    run.cancel()
    await asyncio.wait([run])

    assert run.cancelled()
