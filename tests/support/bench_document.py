"""Write docs/benchmarks.md from the stored results: `python -m tests.support.bench_document`.

A section without a stored result stays as it is, so a single bench can be run again.
"""

import json
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from tests.support.bench import PROJECT, RESULTS, Row, columns_of

DOCUMENT = PROJECT / "docs" / "benchmarks.md"

_HEAD = """\
# Benchmarks

`make bench` and `make bench-ros2` write this page; to update a figure, run its bench again.
References are measured in the same run as Pilothouse, since figures of different machines, or of
one machine on different days, are hard to compare. `p50` is the median, `p99` the 99th percentile.
"""

_UNITS = {
    "bytes": "bytes",
    "deg": "°",
    "m": "m",
    "mb": "MB",
    "mps2": "m/s²",
    "ms": "ms",
    "percent": "%",
    "s": "s",
}


def document(results: Iterable[Mapping[str, Any]]) -> str:
    """Return the document with one section per stored result."""
    ordered = list(results)
    machines = list(dict.fromkeys(_machine(result) for result in ordered))
    sections = [_HEAD, *machines]
    for result in ordered:
        sections.append("\n".join(_section(result, several_machines=len(machines) > 1)))
    return "\n".join(sections)


def renewed(before: str, after: str) -> str:
    """Return a document with its sections replaced by those of a newer one, new ones at the end.

    Args:
        before: The old document; empty if there was none.
        after: The newer document, which may have fewer sections.
    """
    head, new = _parted(after)
    _, kept = _parted(before)
    return "\n## ".join([head, *(f"{title}\n{text}" for title, text in (kept | new).items())])


def _parted(text: str) -> tuple[str, dict[str, str]]:
    """Return the text before the first section, and the sections by title."""
    head, *sections = text.split("\n## ")
    parted = (section.partition("\n") for section in sections)
    return head, {title: rest for title, _, rest in parted}


def _section(result: Mapping[str, Any], *, several_machines: bool) -> Iterator[str]:
    yield f"## {result['title']}\n"
    yield f"{result['how']}\n"
    if result["asked"]:
        yield f"Required: {result['asked']}\n"
    yield from _table(result["rows"])
    yield ""
    for note in result["notes"]:
        yield f"{note}\n"
    yield f"`{result['command']}`, {_date(result['measured_at'])}"
    if several_machines:
        yield f"\n{_machine(result)}"
    else:
        yield ""


def _table(rows: Mapping[str, Row]) -> Iterator[str]:
    columns = columns_of(rows)
    yield f"| | {' | '.join(map(_heading, columns))} |"
    yield f"|---|{'---:|' * len(columns)}"
    for label, row in rows.items():
        cells = (_cell(row[column]) if column in row else "" for column in columns)
        yield f"| {label} | {' | '.join(cells)} |"


def _heading(column: str) -> str:
    """Return the name of a column as words, with its unit after a comma."""
    words, _, unit = column.rpartition("_")
    if words and unit in _UNITS:
        return f"{words.replace('_', ' ')}, {_UNITS[unit]}"
    return _UNITS.get(column, column.replace("_", " "))


def _cell(value: float) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}" if value < 1e5 else f"{value:,.0f}"


def _machine(result: Mapping[str, Any]) -> str:
    facts = (f"{name}: {fact}" for name, fact in result["machine"].items())
    return f"Machine: {'; '.join(facts)}.\n"


def _date(moment: str) -> str:
    return f"{moment.removesuffix('+00:00').replace('T', ' ')} UTC"


if __name__ == "__main__":
    stored = [json.loads(file.read_text()) for file in sorted(RESULTS.glob("*.json"))]
    DOCUMENT.write_text(renewed(DOCUMENT.read_text(), document(stored)))
