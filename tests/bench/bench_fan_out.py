"""Frames to very many clients, beside servers that do nothing else, in the same run."""

import sys
import time
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from statistics import median

import pytest

from tests.support.bench import Row, report
from tests.support.fan_out.load import Load, Seen, load
from tests.support.fan_out.node_ws import NoNodeError, node_server
from tests.support.fan_out.open_files import allow_many_files
from tests.support.fan_out.sockets import sends_to
from tests.support.measured_service import PILOTHOUSE, MeasuredService, measured_service, module
from tests.support.process_usage import first_and_last_core

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
]

PATH = "/ws?topics=system_state"
"""So that each frame is of the same size, as those of the servers beside it."""
OURS, PICOWS = "`pilothouse serve`", "picows"
SETTLE_S = 0.5
ALL_COUNTS: Mapping[int, float] = {1: 2.0, 100: 3.0, 500: 10.0, 1_000: 4.0, 2_000: 4.0}
ROUNDS: tuple[Mapping[int, float], ...] = (ALL_COUNTS, ALL_COUNTS, {500: 10.0})
"""Of each round, how long what number of clients is measured, s."""
MANY = 500
NOT_READING_S = 15.0
LOOK_EVERY_S = 0.05


@dataclass(frozen=True, slots=True)
class _Server:
    command: tuple[str, ...]
    environment: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Window:
    """What one server did for one number of clients."""

    connected: int
    cpu_percent: float
    client_cpu_percent: float
    seen: Seen


def test_frames_to_very_many_clients() -> None:
    allow_many_files()
    servers, notes = _servers(size := _size_of_our_frame())
    windows: dict[tuple[int, str], list[_Window]] = defaultdict(list)
    for counts in ROUNDS:
        for name, server in servers.items():
            for count, window in _measure(server, counts):
                windows[count, name].append(window)
    rows = {
        _label(count, name): _row(windows, count, name) for count in ALL_COUNTS for name in servers
    }
    report(
        "fan_out",
        "Frames to very many clients",
        f"20 frames of {size} bytes per second to each client. The server runs on one core, all "
        "its clients in one process on another core; servers are measured in turn. Figures are "
        f"medians of two rounds, at {MANY} clients of three. CPU is the share of one core. `beyond "
        "1` is the cost of all clients except the first: it excludes the rest of the robot, which "
        f"the reference servers do not have. `of {PICOWS}` are the ratios to {PICOWS}. The delay "
        "is measured from the time in the frame, in whole milliseconds; the spread from the first "
        "client with the same frame. Both include the time that the clients' process needs to read "
        "one client after another. Uvicorn serves an ASGI application that awaits one send after "
        "another. `prepared frames alone` is our protocol class with a bare loop over all "
        "transports, without robot, groups and pings.",
        rows,
        asked=f"at {MANY} clients, at most the CPU of {PICOWS}; at 2,000, p99 delay below 50 ms.",
        notes=notes,
    )
    for count in ALL_COUNTS:
        assert rows[_label(count, OURS)]["connected"] == count
        assert rows[_label(count, OURS)]["lost"] == 0


def test_a_client_that_stops_reading_costs_the_others_nothing() -> None:
    allow_many_files()
    rows: dict[str, Row] = {}
    with _serving(_Server(PILOTHOUSE)) as (service, clients):
        connected = clients.connect(MANY)
        time.sleep(SETTLE_S)
        rows["all read"] = _others(_watch(service, clients, connected, 5.0).seen)
        port = clients.stop_reading()
        clients.begin()
        begin = time.perf_counter()
        while sends_to(port) and time.perf_counter() < begin + NOT_READING_S:
            time.sleep(LOOK_EVERY_S)
        took = time.perf_counter() - begin
        dropped = not sends_to(port)
        rows["one does not read"] = {
            **_others(clients.end()),
            **({"dropped_after_s": round(took, 2)} if dropped else {}),
        }
    report(
        "fan_out_stalled_client",
        "A client that stops reading",
        f"One of {connected} clients stops reading and answering pings. Delay and spread are those "
        "of the other clients, before that and until the server drops the connection.",
        rows,
        asked="dropped within 5 s, without delaying any other client.",
    )
    assert dropped
    assert rows["one does not read"]["lost"] == 0


def _servers(size: int) -> tuple[dict[str, _Server], list[str]]:
    """Return the servers to measure, and why some are not measured."""
    package = "tests.support.fan_out"
    servers = {
        OURS: _Server(PILOTHOUSE),
        PICOWS: _Server(module(f"{package}.picows_server", str(size))),
        "`websockets.broadcast`": _Server(module(f"{package}.websockets_server", str(size))),
        "prepared frames alone": _Server(module(f"{package}.prepared_server", str(size))),
        "uvicorn as it comes": _Server(module(f"{package}.uvicorn_server", str(size))),
    }
    try:
        node = node_server()
    except NoNodeError as error:
        return servers, [f"Without node's `ws`: {error}."]
    servers["node `ws`"] = _Server((*node.command, str(size)), node.environment)
    return servers, []


def _size_of_our_frame() -> int:
    with _serving(_Server(PILOTHOUSE)) as (service, clients):
        return round(_watch(service, clients, clients.connect(1), 1.0).seen.frame_bytes)


@contextmanager
def _serving(server: _Server) -> Iterator[tuple[MeasuredService, Load]]:
    """Run a server on the first core, and a process for its clients on the last."""
    first, last = first_and_last_core()
    with (
        measured_service(server.command, first, server.environment) as service,
        load(service.host, PATH, last) as clients,
    ):
        yield service, clients


def _measure(server: _Server, counts: Mapping[int, float]) -> Iterator[tuple[int, _Window]]:
    """Yield what a server does for more and more clients."""
    with _serving(server) as (service, clients):
        for count, seconds in counts.items():
            connected = clients.connect(count)
            time.sleep(SETTLE_S)
            yield count, _watch(service, clients, connected, seconds)


def _watch(service: MeasuredService, clients: Load, connected: int, seconds: float) -> _Window:
    clients.begin()
    begin = time.perf_counter()
    server_s, client_s = service.usage.cpu_s(), clients.usage.cpu_s()
    time.sleep(seconds)
    server_s, client_s = service.usage.cpu_s() - server_s, clients.usage.cpu_s() - client_s
    took = time.perf_counter() - begin
    return _Window(connected, 100 * server_s / took, 100 * client_s / took, clients.end())


def _label(count: int, name: str) -> str:
    return f"{count:,} client{'s' * (count > 1)}, {name}"


def _row(windows: Mapping[tuple[int, str], list[_Window]], count: int, name: str) -> Row:
    found = windows[count, name]
    delays = [window.seen.delay for window in found]
    spreads = [window.seen.spread for window in found]
    return {
        "CPU_percent": round(_cpu(found), 1),
        **(_ratios(windows, count, name) if count > 1 else {}),
        "delay_p50_ms": _median(delays, "p50_ms"),
        "delay_p99_ms": _median(delays, "p99_ms"),
        "spread_p99_ms": _median(spreads, "p99_ms"),
        "lost": sum(window.seen.lost for window in found),
        "connected": min(window.connected for window in found),
        "clients'_CPU_percent": round(median(window.client_cpu_percent for window in found), 1),
    }


def _ratios(windows: Mapping[tuple[int, str], list[_Window]], count: int, name: str) -> Row:
    cpu, control = _cpu(windows[count, name]), _cpu(windows[count, PICOWS])
    beyond, control_beyond = cpu - _cpu(windows[1, name]), control - _cpu(windows[1, PICOWS])
    return {
        "of_picows": round(cpu / control, 2),
        "beyond_1_percent": round(beyond, 1),
        "beyond_1_of_picows": round(beyond / control_beyond, 2),
    }


def _cpu(windows: list[_Window]) -> float:
    return median(window.cpu_percent for window in windows)


def _median(quantiles: Iterable[Mapping[str, float]], which: str) -> float:
    return round(median(each[which] for each in quantiles), 1)


def _others(seen: Seen) -> dict[str, float]:
    return {
        "delay_p50_ms": seen.delay["p50_ms"],
        "delay_p99_ms": seen.delay["p99_ms"],
        "spread_p99_ms": seen.spread["p99_ms"],
        "lost": seen.lost,
        "frames": seen.frames,
    }
