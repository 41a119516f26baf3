import asyncio
import threading
from functools import partial

import pytest

from service.call_thread import CallThread


async def test_calls_run_in_order_in_one_thread_of_their_own() -> None:
    thread = CallThread("disk")
    names: list[str] = []

    def call(number: int) -> int:
        names.append(threading.current_thread().name)
        return number

    results = await asyncio.gather(*(thread.run(partial(call, n)) for n in range(5)))

    assert results == [0, 1, 2, 3, 4]
    assert names == ["disk"] * 5
    thread.end()


async def test_what_a_call_raises_is_raised_where_it_is_awaited() -> None:
    thread = CallThread("disk")

    def fail() -> None:
        raise OSError("no disk")

    with pytest.raises(OSError, match="no disk"):
        await thread.run(fail)
    thread.end()


async def test_the_loop_goes_on_while_the_disk_is_slow() -> None:
    thread = CallThread("disk")
    gate = threading.Event()

    slow = thread.run(gate.wait)
    await asyncio.sleep(0)
    assert not slow.done()

    gate.set()
    assert await slow
    thread.end()


async def test_nobody_has_to_wait_for_a_call_any_more() -> None:
    thread = CallThread("disk")
    gate = threading.Event()
    slow = thread.run(gate.wait)
    following = thread.run(lambda: "done")

    slow.cancel()
    gate.set()

    assert await following == "done"
    thread.end()


def test_a_loop_that_ended_meanwhile_is_no_concern() -> None:
    thread = CallThread("disk")
    gate, ended = threading.Event(), threading.Event()

    async def begin() -> None:
        thread.run(gate.wait)

    asyncio.run(begin())
    gate.set()

    async def go_on() -> None:
        await thread.run(ended.set)

    asyncio.run(go_on())
    assert ended.is_set()
    thread.end()
