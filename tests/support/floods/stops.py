"""How long an emergency stop takes while a service is flooded."""

import asyncio
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from tests.support.bench import PROJECT
from tests.support.floods.flood import HOST
from tests.support.measured_service import module

PATIENCE_S = 5.0
"""A stop that is not answered within this time is given up and counted as this."""
_EVERY_S = 0.05
_BODY = b'{"engaged": true, "reason": "bench"}'


@contextmanager
def flooding(host: str, floods: str, name: str) -> Iterator[None]:
    """Flood a service while the context lasts.

    Args:
        host: Its address and port.
        floods: The module whose `..._FLOODS` has the flood.
        name: Of the flood.
    """
    command = module("tests.support.floods.sender", floods, name, host)
    with subprocess.Popen(command, cwd=PROJECT, stdout=subprocess.PIPE, text=True) as sender:
        try:
            assert sender.stdout is not None
            assert sender.stdout.readline()
            yield
        finally:
            sender.kill()


@dataclass(frozen=True, slots=True)
class Stop:
    """One emergency stop."""

    took_s: float
    """From connecting to the head of its answer."""
    cpu_s: float
    """What the service worked meanwhile: it does not depend on what else the machine does."""


async def stops(
    host: str, seconds: float, cpu_s: Callable[[], float], token: str = ""
) -> list[Stop]:
    """Stop the robot again and again, each time over a new connection from this address.

    Args:
        host: Address and port.
        seconds: For how long.
        cpu_s: Returns the processor time of the service's event loop so far.
        token: Of the service.
    """
    done: list[Stop] = []
    until = time.perf_counter() + seconds
    while time.perf_counter() < until:
        begin, worked = time.perf_counter(), cpu_s()
        try:
            async with asyncio.timeout(PATIENCE_S):
                await _stop(host, token)
        except (TimeoutError, OSError, EOFError):
            took = PATIENCE_S
        else:
            took = time.perf_counter() - begin
        done.append(Stop(took, cpu_s() - worked))
        await asyncio.sleep(_EVERY_S)
    return done


async def _stop(host: str, token: str) -> None:
    address, _, port = host.rpartition(":")
    reader, writer = await asyncio.open_connection(address, int(port))
    try:
        key = f"Authorization: Bearer {token}\r\n".encode() if token else b""
        length = f"Content-Length: {len(_BODY)}\r\n\r\n".encode()
        head = b"PUT /emergency_stop HTTP/1.1\r\n" + HOST + key
        writer.write(head + b"Content-Type: application/json\r\n" + length + _BODY)
        answer = await reader.readuntil(b"\r\n\r\n")
        assert answer.startswith(b"HTTP/1.1 200"), answer
    finally:
        writer.transport.abort()
