"""What it costs to watch the computer itself."""

import statistics
import sys
import time
from collections import defaultdict
from pathlib import Path

import pytest

from tests.support.bench import Row, report
from tests.support.measured_service import PILOTHOUSE, MeasuredService, measured_service

pytestmark = [
    pytest.mark.bench,
    pytest.mark.timeout(600),
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
]

WATCHED = {
    "cpu": "{what: cpu_percent}",
    "memory": "{what: memory_percent}",
    "disk": "{what: disk_percent}",
    "network": "{what: network_received_bytes_per_s}",
    "clock": "{what: clock_offset_s}",
    "process_cpu": "{what: cpu_percent, process: pilothouse}",
    "process_memory": "{what: memory_bytes, process: pilothouse}",
}
SETTLE_S = 15.0
"""By then what is read every 10 s was read twice."""
SECONDS = 30.0
ROUNDS = 3


def test_what_it_costs_to_watch_the_computer(tmp_path: Path) -> None:
    files = {"not watched": _robot(tmp_path, watched=False), "watched": _robot(tmp_path)}
    seen = defaultdict[str, list[Row]](list)
    for _ in range(ROUNDS):
        for name, file in files.items():
            with measured_service((*PILOTHOUSE, "--robot", str(file))) as service:
                seen[name].append(_cost(service))
    rows = {name: _median(costs) for name, costs in seen.items()}
    control, watched = rows["not watched"], rows["watched"]
    rows["more"] = {key: round(watched[key] - control[key], 2) for key in watched}
    report(
        "sources",
        "The computer watched",
        f"CPU over {SECONDS:g} s, as the share of a core, and memory of `pilothouse serve` with "
        f"the example robot: with sources of {', '.join(WATCHED)}, in their usual periods, and "
        f"with the same signals, but without sources. Medians of {ROUNDS} rounds in turn.",
        rows,
        asked="at most 1 % of a core and 5 MB more.",
    )


def _robot(folder: Path, *, watched: bool = True) -> Path:
    file = folder / f"{'watched' if watched else 'control'}.yaml"
    lines = [
        f"  {name}: {{severity: warning{f', source: {{os: {what}}}' if watched else ''}}}"
        for name, what in WATCHED.items()
    ]
    file.write_text("\n".join(["signals:", *lines, ""]))
    return file


def _cost(service: MeasuredService) -> Row:
    time.sleep(SETTLE_S)
    begin, before = time.perf_counter(), service.usage.cpu_s()
    time.sleep(SECONDS)
    used_s = service.usage.cpu_s() - before
    percent = 100 * used_s / (time.perf_counter() - begin)
    return {"CPU_percent": percent, **service.usage.figures()}


def _median(costs: list[Row]) -> dict[str, float]:
    return {key: round(statistics.median(cost[key] for cost in costs), 2) for key in costs[0]}
