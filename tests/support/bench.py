"""What benches have in common: quantiles, a table to look at, and a file to compare with later."""

import json
import os
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

from api.profiling.machine import machine_facts

PROJECT = Path(__file__).resolve().parents[2]
RESULTS = PROJECT / "build" / "bench"

Row = Mapping[str, float]


def quantile(values: Sequence[float], share: float) -> float:
    """Return the value below which a share of all lies, as the nearest one that was seen."""
    return sorted(values)[round(share * (len(values) - 1))]


def quantiles(values: Sequence[float]) -> dict[str, float]:
    """Return median, 99th percentile and maximum of values in seconds, as milliseconds."""
    ordered = sorted(values)
    last = len(ordered) - 1
    return {
        "p50_ms": round(1000 * ordered[last // 2], 3),
        "p99_ms": round(1000 * ordered[round(0.99 * last)], 3),
        "max_ms": round(1000 * ordered[-1], 3),
    }


def report(
    name: str,
    title: str,
    how: str,
    rows: Mapping[str, Row],
    *,
    asked: str = "",
    notes: Sequence[str] = (),
    command: str | None = None,
) -> None:
    """Print a table, and store it for `docs/benchmarks.md` as `build/bench/<name>.json`.

    Args:
        name: Of the file.
        title: A headline.
        how: What is measured, and how.
        rows: Figures by label.
        asked: The bounds that the figures are to keep.
        notes: What a reader has to know of this very run.
        command: Which measures it again; None: `make bench` of the bench's file.
    """
    bench = os.environ["PYTEST_CURRENT_TEST"].partition("::")[0]
    result = {
        "title": title,
        "how": how,
        "asked": asked,
        "notes": list(notes),
        "command": command or f"make bench ARGS={bench}",
        "measured_at": datetime.now(UTC).isoformat(timespec="minutes"),
        "machine": machine_facts(),
        "rows": rows,
    }
    RESULTS.mkdir(parents=True, exist_ok=True)
    (RESULTS / f"{name}.json").write_text(json.dumps(result, indent=2) + "\n")
    _print(name, rows, notes)


def columns_of(rows: Mapping[str, Row]) -> list[str]:
    """Return all columns of a table, in the order in which they first appear."""
    return list(dict.fromkeys(column for row in rows.values() for column in row))


def _print(name: str, rows: Mapping[str, Row], notes: Sequence[str]) -> None:
    columns = columns_of(rows)
    width = max(map(len, rows))
    print(f"\n{name:{width}} " + " ".join(f"{column:>10}" for column in columns))
    for label, row in rows.items():
        cells = (
            f"{row[column]:>{max(10, len(column))}g}"
            if column in row
            else " " * max(10, len(column))
            for column in columns
        )
        print(f"{label:{width}} " + " ".join(cells))
    for note in notes:
        print(f"  {note}")
