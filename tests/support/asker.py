"""Requests over one connection, without a library, whose time would be measured as well."""

import asyncio
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Self


class Asker:
    """Asks one request after the other."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._reader, self._writer = reader, writer

    @classmethod
    async def open(cls, host: str) -> Self:
        """Return one that is connected to an address and port."""
        address, _, port = host.rpartition(":")
        return cls(*await asyncio.open_connection(address, int(port)))

    async def ask(self, request: str, body: str = "") -> tuple[float, float]:
        """Return when a request was sent, and how many seconds the answer took, a success."""
        begin = self.send(request, body)
        answer = await self.answer()
        return begin, answer - begin

    def send(self, request: str, body: str = "") -> float:
        """Send a request, and return when that was, in seconds of `time.perf_counter`."""
        head = f"{request} HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: {len(body)}\r\n"
        kind = "Content-Type: application/json\r\n" if body else ""
        begin = time.perf_counter()
        self._writer.write(f"{head}{kind}\r\n{body}".encode())
        return begin

    async def answer(self) -> float:
        """Read the answer to the end of its body, and return when its head had come."""
        head = (await self._reader.readuntil(b"\r\n\r\n")).decode().lower()
        came = time.perf_counter()
        # 204 has none.
        length = int(head.partition("content-length:")[2].partition("\r\n")[0] or 0)
        body = await self._reader.readexactly(length)
        assert head.startswith("http/1.1 2"), head + body.decode()
        return came

    async def close(self) -> None:
        """Close the connection."""
        self._writer.close()
        await self._writer.wait_closed()


@asynccontextmanager
async def asking(host: str) -> AsyncIterator[Asker]:
    """Connect to an address and port as long as the context lasts."""
    asker = await Asker.open(host)
    try:
        yield asker
    finally:
        await asker.close()
