"""Drives for ever at 1.5 m/s through the output of a link, and stalls when it is told to.

Prints `driving PID` once commands reach the topic, with the id of the process that publishes them.
A line on the standard input is a way to stall for 3 s: `loop` or `lock`; `end` ends it in order.
"""

import asyncio
import ctypes
import sys
import time
from contextlib import suppress

from domain.vehicle import DriveCommand
from service.ros.graph.link import RosLink

STALL_S = 3
PERIOD_S = 0.05


def stall(how: str) -> None:
    """Keep the event loop, or with it the lock of the interpreter."""
    if how == "loop":
        time.sleep(STALL_S)
    else:
        # PyDLL keeps the lock during the call.
        ctypes.PyDLL(None).usleep(STALL_S * 1_000_000)


async def drive() -> None:
    """Drive until `end`."""
    link = RosLink()
    output = link.drive_output("/cmd_vel", "geometry_msgs/msg/Twist", 2.0)
    running = asyncio.create_task(output.run(lambda: None))
    orders: asyncio.Queue[str] = asyncio.Queue()
    asyncio.get_running_loop().add_reader(
        sys.stdin, lambda: orders.put_nowait(sys.stdin.readline().strip())
    )
    told = None
    while True:
        if not output.trouble and output.pid != told:
            told = output.pid
            print(f"driving {told}", flush=True)
        output.send(DriveCommand(1.5, 0.0))
        await asyncio.sleep(PERIOD_S)
        if not orders.empty():
            order = orders.get_nowait()
            if order == "end":
                break
            stall(order)
    running.cancel()
    with suppress(asyncio.CancelledError):
        await running
    await link.close()


if __name__ == "__main__":
    asyncio.run(drive())
