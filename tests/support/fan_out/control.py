"""What the servers beside ours have in common: frames of a given size, 20 times a second.

Each is written as the documentation of its library says. Its command line ends with the size.
"""

import asyncio
import sys
import time
from collections.abc import Awaitable, Callable
from datetime import UTC, datetime

import uvloop

from tests.support.bare_loop import PERIOD_S, sleep_until

_MORE = '"skipped":0,"filling":"'


def frame(number: int, size: int) -> str:
    """Return a frame of `size` bytes that begins as ours do, with its number and time."""
    at = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
    text = f'{{"type":"state","seq":{number},"at":"{at}",{_MORE}'
    return f'{text}{"x" * (size - len(text) - 2)}"}}'


def serve_frames(
    start: Callable[[], Awaitable[int]], send: Callable[[str], Awaitable[None]]
) -> None:
    """Run a server until the process is killed.

    Args:
        start: Begins to listen on a free port of 127.0.0.1, and returns it.
        send: Sends a frame to all clients.
    """
    with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        runner.run(_serve(start, send, int(sys.argv[-1])))


async def _serve(
    start: Callable[[], Awaitable[int]], send: Callable[[str], Awaitable[None]], size: int
) -> None:
    print(f"page  http://127.0.0.1:{await start()}/\nCtrl-C", flush=True)
    begin = time.perf_counter()
    number = 0
    while True:
        number += 1
        await send(frame(number, size))
        await sleep_until(begin + number * PERIOD_S)
