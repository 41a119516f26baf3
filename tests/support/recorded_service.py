"""A service that writes down when it ticked and what it told the vehicle, for benches.

Times of several processes are compared: `time.perf_counter` is one clock for all of a machine.
"""

import asyncio
import json
import signal
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

from tests.support.bare_loop import PERIOD_S
from tests.support.bench import PROJECT, Row, quantiles
from tests.support.measured_service import module
from tests.support.process import ServiceProcess, connect, service

_RECORDING = """\
import json, sys, time
from importlib.util import find_spec
from api.cli import command_line
from domain.commands import Drive
from service.supervisor import Supervisor

path, found = sys.argv.pop(1), {"asks": [], "drives": [], "ticks": []}
run = Supervisor.run

async def run_recording(supervisor):
    backend = supervisor._backend
    send = backend.send

    def send_recording(command):
        send(command)
        if isinstance(command, Drive):
            found["drives"].append((time.perf_counter(), command.command.speed_mps))

    backend.send = send_recording
    supervisor.publisher.on_tick.append(lambda _: found["ticks"].append(time.perf_counter()))
    await run(supervisor)

Supervisor.run = run_recording
if find_spec("rclpy") is not None:
    from rclpy.client import Client

    call = Client.call_async

    def call_recording(client, request):
        answer = call(client, request)
        if client.service_name.rpartition("/")[2] in ("change_state", "set_parameters_atomically"):
            found["asks"].append(time.perf_counter())
        return answer

    Client.call_async = call_recording
code = command_line.main()
json.dump(found, open(path, "w"))
raise SystemExit(code)
"""


@dataclass(frozen=True, slots=True)
class Record:
    """What the service wrote down."""

    asks: list[float]
    """When ROS 2 had taken over what a node was asked for."""
    drives: list[tuple[float, float]]
    """When it told the vehicle a speed, and which, m/s."""
    ticks: list[float]


@dataclass(frozen=True, slots=True)
class Watched:
    """What a client saw while it followed the stream."""

    window: tuple[float, float]
    arrivals: list[float] = field(default_factory=list)
    seqs: list[int] = field(default_factory=list)
    tasks: list[dict[str, Any]] = field(default_factory=list)
    bare: list[float] = field(default_factory=list)
    """When a loop ticked beside it that does nothing else."""

    @property
    def missing(self) -> int:
        """Frames that did not come."""
        return self.seqs[-1] - self.seqs[0] + 1 - len(self.seqs)


class RecordedService:
    """A service that writes down what it does.

    Args:
        process: The service.
        record: Where it writes to when it ends.
    """

    def __init__(self, process: ServiceProcess, record: Path) -> None:
        self.process = process
        self._record = record

    @property
    def host(self) -> str:
        """Address and port."""
        return str(self.process.url).removeprefix("http://")

    async def watch(self, seconds: float) -> Watched:
        """Follow the stream, with a bare loop beside it."""
        bare = await asyncio.create_subprocess_exec(
            *module("tests.support.bare_loop", str(round(seconds / PERIOD_S))),
            cwd=PROJECT,
            stdout=asyncio.subprocess.PIPE,
        )
        async with connect(f"{self.process.stream_url}?topics=task") as client:
            # The greeting, and a frame at once: only those after them come with the ticks.
            await client.recv()
            await client.recv()
            begin = time.perf_counter()
            seen = Watched((begin, begin + seconds))
            while time.perf_counter() < begin + seconds:
                frame = json.loads(await client.recv())
                if frame["type"] == "state":
                    seen.arrivals.append(time.perf_counter())
                    seen.seqs.append(frame["seq"])
                    if frame.get("task"):
                        seen.tasks.append(frame["task"])
        seen.bare.extend(json.loads((await bare.communicate())[0]))
        return seen

    def end(self) -> Record:
        """End it, and return what it wrote down."""
        self.process.send_signal(signal.SIGTERM)
        self.process.ended()
        return Record(**json.loads(self._record.read_text()))


@contextmanager
def recorded_service(folder: Path, *arguments: str) -> Iterator[RecordedService]:
    """Run `pilothouse serve` with further options, as long as the context lasts.

    Args:
        folder: Where files may be written.
        arguments: More options.
    """
    script, record = folder / "recording.py", folder / "record.json"
    script.write_text(_RECORDING)
    command = (sys.executable, str(script), str(record))
    with service(*arguments, command=command) as process:
        yield RecordedService(process, record)


def period_rows(watched: Mapping[str, Watched], record: Record) -> dict[str, Row]:
    """Return how far periods were from 50 ms: of a bare loop, at the server, and at the client."""
    rows: dict[str, Row] = {}
    for label, seen in watched.items():
        begin, end = seen.window
        ticks = [at for at in record.ticks if begin <= at <= end]
        rows[f"{label}, bare loop"] = _errors(seen.bare)
        rows[f"{label}, tick at the server"] = {**_errors(ticks), "ticks": len(ticks)}
        rows[f"{label}, frame at a client"] = {**_errors(seen.arrivals), "missing": seen.missing}
    return rows


def _errors(times: Sequence[float]) -> dict[str, float]:
    return quantiles([abs(after - before - PERIOD_S) for before, after in pairwise(times)])
