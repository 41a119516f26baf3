"""What the link between computers costs, how fast it is, and what a flood on it does."""

import asyncio
import shutil
import sys
import time
from collections.abc import Coroutine
from pathlib import Path
from typing import TypeVar

import pytest
import uvloop

from domain.computers import SUPERVISOR, ComputerName
from domain.timebase import seconds, to_seconds
from service.clock import MonotonicClock
from service.link.port import MAX_MESSAGES_PER_S
from service.link.wire import decode
from tests.support.bench import Row, quantiles, report
from tests.support.certificates import make_certificates
from tests.support.container import free_port
from tests.support.link_peers import (
    BEAT_S,
    FLOOD_PER_S,
    a_beat,
    link_of,
    other_computers,
)
from tests.support.links import RunningLink

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(sys.platform != "linux", reason="measured on Linux only"),
    pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is not installed"),
]

BASE, ARM = ComputerName("base"), ComputerName("arm")
DEVICES = [ComputerName(f"device_{number}") for number in range(20)]
PROTOCOLS = ("tcp", "tls", "quic")
ROUND_TRIPS = 500
PAUSE_S = 0.025
"""Between two of them: less than the beats that one computer may send."""
SECONDS = 10.0
TICK = seconds(0.05)

Result = TypeVar("Result")


def run(work: Coroutine[object, object, Result]) -> Result:
    """Run on the loop of the service."""
    with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
        return runner.run(work)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    names = (SUPERVISOR, BASE, ARM, *DEVICES)
    return make_certificates(tmp_path_factory.mktemp("certificates"), *names)


class Supervisor:
    """The supervisor, with other computers in another process."""

    def __init__(self, protocol: str, folder: Path, *devices: ComputerName) -> None:
        self.at = f"{protocol}/127.0.0.1:{free_port()}"
        self.folder = None if protocol == "tcp" else folder
        link = link_of(SUPERVISOR, [SUPERVISOR, *devices], self.at, self.folder)
        self.running = RunningLink(SUPERVISOR, link)
        self.heard: dict[ComputerName, int] = dict.fromkeys(devices, 0)
        self.running.when_heard = self._count

    async def hear_all(self) -> None:
        """Wait until each device was heard."""
        async with asyncio.timeout(30.0):
            while not all(self.heard.values()):
                await self.running.news()

    def _count(self, sender: ComputerName, _: bytes) -> None:
        self.heard[sender] += 1
        self.running.received.clear()


# --- how fast ----------------------------------------------------------------------------------


def test_how_long_a_message_is_under_way(folder: Path) -> None:
    rows: dict[str, Row] = {}
    for protocol in PROTOCOLS:
        for kind, may_be_lost in (("beats", True), ("messages", False)):
            times = run(_round_trips(protocol, folder, may_be_lost=may_be_lost))
            lost = ROUND_TRIPS - len(times)
            rows[f"{protocol}, {kind}"] = {**quantiles(times), "lost": lost}
    report(
        "link_round_trip",
        "There and back over the link",
        f"Time of {ROUND_TRIPS} messages of the length of a beat, forty a second, to another "
        "process over loopback and back to this one.",
        rows,
        asked="a request over the link takes at most 5 ms more than a local one (p99).",
    )
    assert max(row["p99_ms"] for row in rows.values()) < 5.0


async def _round_trips(protocol: str, folder: Path, *, may_be_lost: bool) -> list[float]:
    supervisor = Supervisor(protocol, folder, BASE)
    times: list[float] = []
    text = (b"beat" if may_be_lost else b"message").ljust(len(a_beat(BASE)))
    with other_computers("answer", supervisor.at, supervisor.folder, BASE):
        async with supervisor.running as running:
            while not supervisor.heard[BASE]:
                running.send(BASE, text, may_be_lost=may_be_lost)
                await asyncio.sleep(0.05)
            for _ in range(ROUND_TRIPS):
                before, begin = supervisor.heard[BASE], time.perf_counter()
                running.send(BASE, text, may_be_lost=may_be_lost)
                try:
                    async with asyncio.timeout(0.5):
                        while supervisor.heard[BASE] == before:
                            await running.news()
                    times.append(time.perf_counter() - begin)
                except TimeoutError:
                    continue
                await asyncio.sleep(PAUSE_S)
    return times


# --- how much it costs -------------------------------------------------------------------------


def test_what_two_hundred_beats_a_second_cost(folder: Path) -> None:
    rows = {protocol: run(_cost_of_beats(protocol, folder)) for protocol in PROTOCOLS}
    report(
        "link_beats",
        "What the beats of twenty devices cost",
        f"Processor time of the supervisor's link in {SECONDS:g} s, over all threads: each of 20 "
        "devices sends and gets a beat each 0.1 s, which is parsed. Without the core.",
        rows,
        asked="at rest, a supervisor of 20 devices takes at most 15 % of a core.",
    )
    assert max(row["cpu_percent"] for row in rows.values()) < 15.0


async def _cost_of_beats(protocol: str, folder: Path) -> Row:
    supervisor = Supervisor(protocol, folder, *DEVICES)
    text = a_beat(SUPERVISOR)
    with other_computers("beat", supervisor.at, supervisor.folder, *DEVICES):
        async with supervisor.running as running:
            await supervisor.hear_all()
            await asyncio.sleep(2.0)
            running.when_heard = lambda sender, message: _parse(supervisor, sender, message)
            before = sum(supervisor.heard.values())
            begin, cpu_s = time.perf_counter(), time.process_time()
            while time.perf_counter() - begin < SECONDS:
                for device in DEVICES:
                    running.send(device, text, may_be_lost=True)
                await asyncio.sleep(BEAT_S)
            took_s = time.perf_counter() - begin
            used_s = time.process_time() - cpu_s
    heard = sum(supervisor.heard.values()) - before
    return {
        "cpu_percent": round(100 * used_s / took_s, 2),
        "beats_heard_per_s": round(heard / took_s, 1),
        "beat_bytes": len(text),
    }


def _parse(supervisor: Supervisor, sender: ComputerName, message: bytes) -> None:
    decode(message)
    supervisor.heard[sender] += 1
    supervisor.running.received.clear()


# --- what a flood does -------------------------------------------------------------------------


def test_a_flood_does_not_delay_the_tick(folder: Path) -> None:
    rows: dict[str, Row] = {"nobody (control)": run(_ticks("tcp", folder, is_flooded=False))}
    for protocol in PROTOCOLS:
        rows[protocol] = run(_ticks(protocol, folder, is_flooded=True))
    report(
        "link_flood",
        "The tick while a device floods the link",
        f"How late a tick of 20 Hz is, for {SECONDS:g} s in which one device sends {FLOOD_PER_S} "
        f"reports a second, of which {MAX_MESSAGES_PER_S} are taken in and parsed; and the beats "
        "of another device meanwhile.",
        rows,
        asked="99 of 100 ticks are less than 5 ms late.",
    )
    assert max(row["p99_ms"] for row in rows.values()) < 5.0
    flooded = [row for label, row in rows.items() if label in PROTOCOLS]
    assert max(row["taken_in_per_s"] for row in flooded) <= 1.2 * MAX_MESSAGES_PER_S
    assert min(row["beats_per_s"] for row in flooded) > 9.0


async def _ticks(protocol: str, folder: Path, *, is_flooded: bool) -> Row:
    supervisor = Supervisor(protocol, folder, BASE, ARM)
    clock = MonotonicClock()
    late: list[float] = []
    what = "flood" if is_flooded else "beat"
    with (
        other_computers(what, supervisor.at, supervisor.folder, BASE),
        other_computers("beat", supervisor.at, supervisor.folder, ARM),
    ):
        async with supervisor.running as running:
            await supervisor.hear_all()
            running.when_heard = lambda sender, message: _parse(supervisor, sender, message)
            await asyncio.sleep(2.0)
            before, cpu_s = dict(supervisor.heard), time.process_time()
            due = clock.now()
            for _ in range(int(SECONDS / to_seconds(TICK))):
                due += TICK
                await clock.sleep_until(due)
                late.append(to_seconds(clock.now() - due))
            used_s = time.process_time() - cpu_s
    return {
        **quantiles(late),
        "taken_in_per_s": round((supervisor.heard[BASE] - before[BASE]) / SECONDS, 1),
        "beats_per_s": round((supervisor.heard[ARM] - before[ARM]) / SECONDS, 2),
        "cpu_percent": round(100 * used_s / SECONDS, 1),
    }
