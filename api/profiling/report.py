"""The report of a profile: text for people, JSON for programs."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any

from api.profiling.analysis import LATENCIES, Summary, summaries
from api.profiling.run_file import Run
from api.terminal_text import counted

_FIGURES = ("min", "mean", "p50", "p95", "p99", "max", "std")
_LABEL = max(len(latency.words) for latency in LATENCIES) + 2
_ENOUGH_FOR_P99 = 100


def report_json(runs: Sequence[Run], setup: Mapping[str, Any]) -> dict[str, Any]:
    """Return the report for programs.

    Args:
        runs: What was measured.
        setup: How and where, as `setup.json` has it; empty if that is not known.
    """
    return {
        "setup": setup,
        "runs": len(runs),
        "failed": sum(not run.is_ok for run in runs),
        "failures": [
            {"run": run.number, "trigger": run.trigger, "reason": run.reason}
            for run in runs
            if not run.is_ok
        ],
        "latencies": [summary.as_json() for summary in summaries(runs)],
    }


def report_lines(runs: Sequence[Run], setup: Mapping[str, Any]) -> Iterator[str]:
    """Yield the report for people; arguments as for `report_json`."""
    yield from _setup_lines(setup)
    yield "Latencies in ms, seen by a WebSocket client; without the persistence of the error."
    few = []
    for trigger, found in groupby(summaries(runs), key=lambda summary: summary.trigger):
        own = [run for run in runs if run.trigger == trigger]
        persistences = sorted({run.persistence_s for run in own})
        subtracted = ", ".join(f"{value:g}" for value in persistences if value)
        yield ""
        head = f"{trigger}, {counted(len(own), 'run')}"
        yield f"{head}, persistence {subtracted} s subtracted" if subtracted else head
        yield f"  {'':{_LABEL}}{'count':>6}{'failed':>8}" + _cells(_FIGURES)
        yield from (_line(summary) for summary in found)
        if len(own) < _ENOUGH_FOR_P99:
            few.append(trigger)
    yield ""
    if few:
        yield f"With fewer than {_ENOUGH_FOR_P99} runs, p99 is little more than the maximum."
    yield from _failures(runs)


def _setup_lines(setup: Mapping[str, Any]) -> Iterator[str]:
    if not setup:
        return
    yield f"Pilothouse {setup['version']}, measured at {setup['started_at']}"
    for name in ("machine", "load"):
        if facts := ", ".join(f"{key} {value}" for key, value in setup[name].items()):
            yield f"{name.capitalize()}: {facts}"
    for changed in setup["changed_settings"]:
        yield f"Setting: {changed}"


def _line(summary: Summary) -> str:
    shown = [f"{summary.figures[name]:.2f}" if summary.figures else "-" for name in _FIGURES]
    head = f"  {summary.latency.words:{_LABEL}}{summary.count:>6}{summary.failed:>8}"
    return head + _cells(shown)


def _cells(texts: Sequence[str]) -> str:
    return "".join(f"{text:>9}" for text in texts)


def _failures(runs: Sequence[Run]) -> Iterator[str]:
    failed = [run for run in runs if not run.is_ok]
    yield f"{counted(len(runs), 'run')}, {len(failed)} failed"
    for run in failed:
        yield f"  {run.trigger}, run {run.number}: {run.reason}"
