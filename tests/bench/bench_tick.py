"""How evenly the service ticks, beside a bare loop that does nothing else at the same time."""

import asyncio
import json
import signal
import sys
import time
from itertools import pairwise
from pathlib import Path

import pytest
from websockets.asyncio.client import ClientConnection

from tests.support.bench import quantiles, report
from tests.support.process import connect, service

pytestmark = pytest.mark.bench

SECONDS = 60
PERIOD_S = 0.05

RECORDING = """\
import json, sys
from api import command_line, serving

path, periods, compose = sys.argv.pop(1), [], serving.compose

def compose_recording(options, clock):
    supervisor = compose(options, clock)
    supervisor.on_tick.append(periods.append)
    return supervisor

serving.compose = compose_recording
code = command_line.main()
json.dump(periods, open(path, "w"))
raise SystemExit(code)
"""

BARE = """\
import asyncio, json, sys
import uvloop
from domain.timebase import seconds
from service.clock import MonotonicClock

async def tick(count):
    clock, times = MonotonicClock(), []
    start = clock.now()
    for number in range(count):
        await clock.sleep_until(start + number * seconds(0.05))
        times.append(clock.now())
    return [(after - before) / 1e9 for before, after in zip(times, times[1:])]

with asyncio.Runner(loop_factory=uvloop.new_event_loop) as runner:
    json.dump(runner.run(tick(int(sys.argv[1]))), sys.stdout)
"""


async def test_the_tick_keeps_its_period(tmp_path: Path) -> None:
    script, recorded = tmp_path / "recording.py", tmp_path / "periods.json"
    script.write_text(RECORDING)
    command = (sys.executable, str(script), str(recorded))
    with service(command=command) as running:
        async with connect(running.stream_url) as client:
            # In the first second the robot comes up, and what changes is told between the ticks.
            await _follow(client, 1)
            bare = await asyncio.create_subprocess_exec(
                sys.executable, "-c", BARE, str(SECONDS * 20), stdout=asyncio.subprocess.PIPE
            )
            arrivals, seqs = await _follow(client, SECONDS)
            output, _ = await bare.communicate()
        running.send_signal(signal.SIGTERM)
        running.ended()
    ticks = json.loads(recorded.read_text())
    rows = {
        "bare loop": _errors(json.loads(output)),
        "tick at the server": _errors(ticks[20:]),
        "frame at a client": _errors([after - before for before, after in pairwise(arrivals)]),
    }
    missing = seqs[-1] - seqs[0] + 1 - len(seqs)
    rows["frame at a client"] |= {"frames": len(seqs), "missing": missing}
    report("tick", rows)
    assert missing == 0
    assert abs(len(seqs) - SECONDS * 20) <= 2


async def _follow(client: ClientConnection, seconds: float) -> tuple[list[float], list[int]]:
    """Return the times of arrival of frames, and their numbers."""
    arrivals: list[float] = []
    seqs: list[int] = []
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        frame = json.loads(await client.recv())
        if frame["type"] == "state":
            arrivals.append(time.perf_counter())
            seqs.append(frame["seq"])
    return arrivals, seqs


def _errors(periods: list[float]) -> dict[str, float]:
    return quantiles([abs(period - PERIOD_S) for period in periods])
