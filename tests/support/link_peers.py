"""Other computers of a robot: `python -m tests.support.link_peers WHAT AT FOLDER NAME...`.

Each answers what it gets, beats ten times a second, or floods the supervisor.
"""

import asyncio
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import uvloop

from domain.computers import SUPERVISOR, ComputerName, Incarnation, Session, StopId
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.link.messages import Beat, EngagedStop, Report, Terms
from domain.state_and_mode import ModeName, PartName
from domain.timebase import seconds
from service.link.endpoints import Endpoints
from service.link.wire import encode
from service.link.zenoh_link import ZenohLink
from tests.support.certificates import certificates_in

BEAT_S = 0.1
FLOOD_PER_S = 10_000
_RUN = Incarnation("d" * 32)
_TERMS = Terms("a" * 64, "b" * 64, version="0.1.0")


def a_beat(sender: ComputerName, seq: int = 1) -> bytes:
    """Return a beat as long as one of a robot that is stopped."""
    stop = EngagedStop(StopId("c" * 32), "operator", "someone is in the cell", seconds(3.0))
    heard, session = Incarnation("e" * 32), Session("f" * 32)
    return encode(Beat(sender, _RUN, seq, _TERMS, heard, seq, session, stops=(stop,)))


def a_report(sender: ComputerName, seq: int = 1) -> bytes:
    """Return a report about one node."""
    node = NodeReport(PartName("drive_base"), LifecycleState.ACTIVE, ModeName("SLOW"))
    return encode(Report(sender, _RUN, seq, (node,)))


def link_of(
    name: ComputerName, names: Sequence[ComputerName], at: str, folder: Path | None
) -> ZenohLink:
    """Return the link of a computer; the supervisor listens at `at`, and the others connect."""
    protocol = at.partition("/")[0]
    own = Endpoints((at,), ())
    if name != SUPERVISOR:
        own = Endpoints((f"{protocol}/127.0.0.1:0",), (at,))
    files = None if folder is None else certificates_in(folder, name)
    return ZenohLink(name, [other for other in names if other != name], own, files)


@contextmanager
def other_computers(
    what: str, at: str, folder: Path | None, *names: ComputerName
) -> Iterator[None]:
    """Run computers in a process of their own."""
    command = [
        sys.executable,
        "-m",
        "tests.support.link_peers",
        what,
        at,
        str(folder or ""),
        *names,
    ]
    with subprocess.Popen(command) as process:
        try:
            yield
        finally:
            process.kill()


async def _answer(name: ComputerName, link: ZenohLink) -> None:
    def deliver(sender: ComputerName, message: bytes) -> None:
        link.send(sender, message, may_be_lost=message.startswith(b"beat"))

    await link.run(deliver)


async def _beat(name: ComputerName, link: ZenohLink) -> None:
    running = asyncio.create_task(link.run(lambda _sender, _message: None))
    text = a_beat(name)
    while not running.done():
        link.send(SUPERVISOR, text, may_be_lost=True)
        await asyncio.sleep(BEAT_S)


async def _flood(name: ComputerName, link: ZenohLink) -> None:
    running = asyncio.create_task(link.run(lambda _sender, _message: None))
    text, loop = a_report(name), asyncio.get_running_loop()
    begin, sent = loop.time(), 0
    while not running.done():
        due = int((loop.time() - begin) * FLOOD_PER_S)
        for _ in range(due - sent):
            link.send(SUPERVISOR, text, may_be_lost=False)
        sent = due
        await asyncio.sleep(0.001)


async def _main(what: str, at: str, folder: str, *names: str) -> None:
    do = {"answer": _answer, "beat": _beat, "flood": _flood}[what]
    devices = [ComputerName(name) for name in names]
    async with asyncio.TaskGroup() as tasks:
        for name in devices:
            link = link_of(name, [SUPERVISOR, *devices], at, Path(folder) if folder else None)
            tasks.create_task(do(name, link))


if __name__ == "__main__":
    uvloop.run(_main(*sys.argv[1:]))
