"""A loop of 20 Hz that does nothing else: how late the machine itself makes a tick.

`python -m tests.support.bare_loop COUNT` prints the time of each of so many ticks, as JSON.
"""

import asyncio
import json
import sys
import time

import uvloop

PERIOD_S = 0.05


async def sleep_until(moment: float) -> None:
    """Sleep until `time.perf_counter` says so."""
    # uvloop counts in whole milliseconds, so that a timer may fire early; without a least pause
    # it would spin through the rest.
    while (left := moment - time.perf_counter()) > 0:  # noqa: ASYNC110
        await asyncio.sleep(max(left, 0.001))


async def tick(count: int) -> list[float]:
    """Return when each tick was, in seconds of `time.perf_counter`."""
    times = []
    start = time.perf_counter()
    for number in range(count):
        await sleep_until(start + number * PERIOD_S)
        times.append(time.perf_counter())
    return times


if __name__ == "__main__":
    with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        json.dump(runner.run(tick(int(sys.argv[1]))), sys.stdout)
