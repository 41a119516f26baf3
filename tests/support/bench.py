"""What benches have in common: quantiles, a table to look at, and a file to compare with later."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

RESULTS = Path(__file__).resolve().parents[2] / "build" / "bench"

Row = Mapping[str, float]


def quantiles(values: Sequence[float]) -> dict[str, float]:
    """Return median, 99th percentile and maximum of values in seconds, as milliseconds."""
    ordered = sorted(values)
    last = len(ordered) - 1
    return {
        "p50_ms": round(1000 * ordered[last // 2], 3),
        "p99_ms": round(1000 * ordered[round(0.99 * last)], 3),
        "max_ms": round(1000 * ordered[-1], 3),
    }


def report(name: str, rows: Mapping[str, Row]) -> None:
    """Print a table with one line per row, and store it as `build/bench/<name>.json`."""
    RESULTS.mkdir(parents=True, exist_ok=True)
    (RESULTS / f"{name}.json").write_text(json.dumps(rows, indent=2) + "\n")
    columns = list(dict.fromkeys(column for row in rows.values() for column in row))
    width = max(map(len, rows))
    print(f"\n{name:{width}} " + " ".join(f"{column:>10}" for column in columns))
    for label, row in rows.items():
        cells = (f"{row[column]:>10g}" if column in row else " " * 10 for column in columns)
        print(f"{label:{width}} " + " ".join(cells))
