"""What the service costs while nothing happens, and how soon it is ready."""

import http.client
import sys
import time
from collections.abc import Sequence

import pytest

from tests.support.bench import Row, quantiles, report
from tests.support.fan_out.load import load
from tests.support.measured_service import (
    PILOTHOUSE,
    MeasuredService,
    measured_service,
    module,
)

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
]

SETTLE_S = 3.0
"""In the first second the robot comes up."""
SECONDS = 10.0
STARTS = 5
RSS_MB = 90.0
MORE = "The RSS is more than required: see decision 64."
READY_WITHIN_S = 20.0
ECHO = module("tests.support.echo_app")


def test_what_an_idle_service_costs() -> None:
    rows: dict[str, Row] = {}
    with measured_service(ECHO) as echo:
        rows["FastAPI alone"] = _cost(echo)
    with measured_service(PILOTHOUSE) as service:
        rows["nobody looks"] = _cost(service)
        # All topics, as the page asks for.
        with load(service.host, "/ws") as page:
            assert page.connect(1) == 1
            page.begin()
            rows["one page"] = _cost(service)
            seen = page.end()
    report(
        "idle",
        "At rest",
        f"CPU over {SECONDS:g} s, as the share of a core, and memory of `pilothouse serve` with "
        "the example robot, without a client and with one that receives what the page does; an "
        "idle FastAPI service is the reference. RSS is that of the service process; `of all` would "
        "include a worker process, which exists from the first posted model or path on.",
        rows,
        asked=f"less than {RSS_MB:g} MB RSS and less than 5 % of a core with one page open.",
        notes=[MORE] if rows["one page"]["RSS_mb"] >= RSS_MB else [],
    )
    assert seen.lost == 0


def test_how_soon_it_is_ready() -> None:
    rows: dict[str, Row] = {
        "FastAPI alone": quantiles([_start(ECHO, "/livez") for _ in range(STARTS)]),
        "`pilothouse serve`": quantiles([_start(PILOTHOUSE, "/readyz") for _ in range(STARTS)]),
    }
    report(
        "idle_start",
        "Start",
        f"From the start of the process to the first 200 of `/readyz`, {STARTS} times; the "
        "reference is an idle FastAPI service, to its first response.",
        rows,
    )


def _cost(service: MeasuredService) -> Row:
    time.sleep(SETTLE_S)
    begin, before = time.perf_counter(), service.usage.cpu_s()
    time.sleep(SECONDS)
    used_s = service.usage.cpu_s() - before
    percent = 100 * used_s / (time.perf_counter() - begin)
    return {"CPU_percent": round(percent, 1), **service.usage.figures()}


def _start(command: Sequence[str], path: str) -> float:
    """Return how long it took from the start of a process until it answers 200, s."""
    begin = time.perf_counter()
    with measured_service(command) as service:
        while not _is_ready(service.host, path):
            assert time.perf_counter() < begin + READY_WITHIN_S, "it never was ready"
        return time.perf_counter() - begin


def _is_ready(host: str, path: str) -> bool:
    connection = http.client.HTTPConnection(host, timeout=READY_WITHIN_S)
    try:
        connection.request("GET", path)
        return connection.getresponse().status == http.client.OK
    except ConnectionError:
        return False
    finally:
        connection.close()
