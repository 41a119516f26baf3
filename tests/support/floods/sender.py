"""Send a flood until killed: `python -m tests.support.floods.sender MODULE NAME HOST`.

Prints a line once all connections have been tried.
"""

import asyncio
import importlib
import os
import resource
import sys
from contextlib import suppress

from tests.support.floods.flood import NUMBER, Flood

_RETRY_S = 0.01


async def _flood(host: str, flood: Flood) -> None:
    address, _, port = host.rpartition(":")
    tried = asyncio.Event()
    left = flood.connections

    async def one(number: int) -> None:
        nonlocal left
        while True:
            with suppress(OSError, EOFError, TimeoutError):
                reader, writer = await asyncio.open_connection(address, int(port))
                left -= 1
                if not left:
                    tried.set()
                async with asyncio.timeout(flood.lasts_s or None):
                    await _send(flood, number, reader, writer)
            await asyncio.sleep(_RETRY_S)

    async with asyncio.TaskGroup() as tasks:
        for number in range(flood.connections):
            tasks.create_task(one(40 * number))
        with suppress(TimeoutError):
            await asyncio.wait_for(tried.wait(), 5.0)
        print("flooding", flush=True)


async def _send(
    flood: Flood, number: int, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
) -> None:
    """Send until the connection is closed.

    Raises:
        OSError, EOFError: It was.
    """
    try:
        if flood.opening:
            writer.write(flood.opening.replace(NUMBER, b"%d" % number))
            await reader.readuntil(b"\r\n\r\n")
        reading = asyncio.create_task(_read(reader if flood.reads else None))
        sending = asyncio.create_task(_repeat(flood, writer))
        try:
            await asyncio.wait({reading, sending}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            reading.cancel()
            sending.cancel()
            await asyncio.gather(reading, sending, return_exceptions=True)
    finally:
        writer.transport.abort()


async def _read(reader: asyncio.StreamReader | None) -> None:
    if reader is None:
        await asyncio.Event().wait()
    while reader is not None and await reader.read(65_536):
        pass


async def _repeat(flood: Flood, writer: asyncio.StreamWriter) -> None:
    if not flood.again:
        await asyncio.Event().wait()
    while True:
        writer.write(flood.again)
        await writer.drain()
        await asyncio.sleep(flood.every_s)


if __name__ == "__main__":
    # The service and who measures it come first.
    os.nice(5)
    _soft, _hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (_hard, _hard))
    _module, _name, _host = sys.argv[1:]
    _floods = next(
        value
        for key, value in vars(importlib.import_module(_module)).items()
        if key.endswith("_FLOODS")
    )
    asyncio.run(_flood(_host, _floods[_name]))
