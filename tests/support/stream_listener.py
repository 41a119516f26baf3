"""Follows the stream in a process of its own, so that who measures does not delay it.

`python -m tests.support.stream_listener HOST:PORT` reads until its input ends, and then prints when
each `state` frame came, what all messages weigh, and when changes ended, as JSON.
"""

import asyncio
import json
import os
import select
import socket
import sys
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from itertools import pairwise

from tests.support.bench import PROJECT
from tests.support.measured_service import module

_HEADER = 2
_LENGTH_16, _LENGTH_64 = 126, 127
_PING = 0x89


@dataclass(frozen=True, slots=True)
class Heard:
    """What came, in seconds of `time.perf_counter` and bytes."""

    frames: list[float]
    sizes: list[tuple[float, int]]
    """When how many bytes came."""
    gaps: int
    """How many times events were lost, and that was said."""

    def longest_gap_s(self, begin: float, end: float) -> float:
        """Return the longest time without a `state` frame, s."""
        within = [begin, *(at for at in self.frames if begin < at < end), end]
        return max(after - before for before, after in pairwise(within))

    def bytes_per_s(self, begin: float, end: float) -> float:
        """Return how much came per second."""
        return sum(size for at, size in self.sizes if begin <= at < end) / (end - begin)


class Listening:
    """A process that follows the stream.

    Args:
        process: Reads its input, and has its output in a pipe.
    """

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    async def heard(self) -> Heard:
        """End it, and return what came."""
        output, _ = await self._process.communicate(b"")
        found = json.loads(output)
        return Heard(found["frames"], [(at, size) for at, size in found["sizes"]], found["gaps"])


@asynccontextmanager
async def listening(host: str) -> AsyncIterator[Listening]:
    """Follow the stream of an address and port as long as the context lasts."""
    process = await asyncio.create_subprocess_exec(
        *module("tests.support.stream_listener", host),
        cwd=PROJECT,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
    )
    try:
        yield Listening(process)
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()


def _listen(host: str) -> None:
    address, _, port = host.rpartition(":")
    stream = socket.create_connection((address, int(port)))
    stream.sendall(
        f"GET /ws HTTP/1.1\r\nHost: {host}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
    )
    frames, sizes, gaps = list[float](), list[tuple[float, int]](), 0
    waiting = b""
    while True:
        ready, _, _ = select.select([stream, sys.stdin], [], [])
        if sys.stdin in ready and not os.read(sys.stdin.fileno(), 1):
            break
        if stream not in ready:
            continue
        data = stream.recv(2**20)
        if not data:
            break
        now = time.perf_counter()
        sizes.append((now, len(data)))
        waiting += data
        if waiting.startswith(b"HTTP"):
            waiting = waiting.partition(b"\r\n\r\n")[2]
        at = 0
        for kind, begin, end in _messages(waiting):
            at = end
            head = waiting[begin : begin + 20]
            if kind == _PING:
                stream.sendall(b"\x8a\x80\0\0\0\0")
            elif head.startswith(b'{"type":"state"'):
                frames.append(now)
            elif head.startswith(b'{"type":"gap"'):
                gaps += 1
        waiting = waiting[at:]
    json.dump({"frames": frames, "sizes": sizes, "gaps": gaps}, sys.stdout)


def _messages(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield kind, begin and end of each message that came whole."""
    at = 0
    while len(data) - at >= _HEADER:
        begin, size = at + 2, data[at + 1]
        if size == _LENGTH_16:
            begin, size = at + 4, int.from_bytes(data[at + 2 : at + 4])
        elif size == _LENGTH_64:
            begin, size = at + 10, int.from_bytes(data[at + 2 : at + 10])
        if len(data) < begin + size:
            return
        yield data[at], begin, begin + size
        at = begin + size


if __name__ == "__main__":
    _listen(sys.argv[1])
