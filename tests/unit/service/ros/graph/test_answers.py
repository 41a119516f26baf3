import asyncio
import threading
import time
from collections.abc import Callable

import pytest

from service.ros.graph.answers import answer_within


def stall(arrive: Callable[[], object]) -> None:
    """Block the loop for longer than the timeout; meanwhile something arrives on a thread."""
    time.sleep(0.1)
    thread = threading.Thread(target=arrive)
    thread.start()
    thread.join()
    time.sleep(0.1)


async def test_an_answer_is_returned() -> None:
    answer: asyncio.Future[int] = asyncio.get_running_loop().create_future()
    asyncio.get_running_loop().call_soon(answer.set_result, 7)
    assert await answer_within(answer, 10) == 7


async def test_an_answer_that_does_not_come_is_waited_for_no_longer() -> None:
    answer: asyncio.Future[int] = asyncio.get_running_loop().create_future()
    with pytest.raises(TimeoutError):
        await answer_within(answer, 0.01)


async def test_an_answer_that_arrived_while_the_loop_stalled_is_not_lost() -> None:
    loop = asyncio.get_running_loop()
    answer: asyncio.Future[int] = loop.create_future()
    waiting = asyncio.create_task(answer_within(answer, 0.05))
    await asyncio.sleep(0)
    stall(lambda: loop.call_soon_threadsafe(answer.set_result, 7))
    assert await waiting == 7


async def test_a_request_that_is_given_up_is_given_up_at_once() -> None:
    answer: asyncio.Future[int] = asyncio.get_running_loop().create_future()
    waiting = asyncio.create_task(answer_within(answer, 10))
    await asyncio.sleep(0)
    waiting.cancel()
    with pytest.raises(asyncio.CancelledError):
        await waiting
