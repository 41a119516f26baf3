"""Parts and signals as rows, and the choice of rows if there is no room for all."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

Json = Mapping[str, Any]

UNREACHABLE, WRONG, CHANGES, CALM = "x", "!", ">", " "
"""Marks in front of a row, the most urgent first."""

MARK_STYLES = {UNREACHABLE: "bold red", WRONG: "bold yellow", CHANGES: "cyan", CALM: ""}

_URGENCY = (UNREACHABLE, WRONG, CHANGES, CALM)


class Row(Protocol):
    """One line of a table."""

    @property
    def name(self) -> str:
        """Return the name of the part or signal."""
        ...

    @property
    def mark(self) -> str:
        """Return what needs attention."""
        ...


RowType = TypeVar("RowType", bound=Row)


@dataclass(frozen=True, slots=True)
class PartRow:
    """A system or node."""

    part: Json

    @property
    def name(self) -> str:
        """Return its name."""
        return str(self.part["name"])

    @property
    def is_system(self) -> bool:
        """Tell whether it is a system, and not a node."""
        return self.part.get("kind") == "system"

    @property
    def mark(self) -> str:
        """Return the mark; only nodes are marked as unreachable, not their systems."""
        part = self.part
        if not part.get("reachable", True) and not self.is_system:
            return UNREACHABLE
        if part.get("change"):
            return CHANGES
        return CALM if part["converged"] else WRONG


@dataclass(frozen=True, slots=True)
class SignalRow:
    """A signal."""

    signal: Json

    @property
    def name(self) -> str:
        """Return its name."""
        return str(self.signal["signal"])

    @property
    def mark(self) -> str:
        """Return the mark; `>` is a pending error."""
        if self.signal["error"] or self.signal["stale"]:
            return WRONG
        return CHANGES if self.signal["pending"] else CALM


@dataclass(frozen=True, slots=True)
class Chosen(Generic[RowType]):
    """The rows that fit, and the number of those left out."""

    rows: tuple[RowType, ...]
    left_out: int = 0
    marked: int = 0
    """Of those left out, the ones that need attention."""


def part_rows(parts: Mapping[str, Json]) -> list[PartRow]:
    """Return a row for each part, systems first, else by name: as in the mode monitor of D4.8.

    Args:
        parts: By name.
    """
    rows = map(PartRow, parts.values())
    return sorted(rows, key=lambda row: (not row.is_system, row.name.encode()))


def choose(rows: Sequence[RowType], room: int | None) -> Chosen[RowType]:
    """Return all rows where they fit; else first those that need attention, then the others.

    Args:
        rows: In their usual order.
        room: Number of lines, of which the last counts what is left out; None: as many as needed.
    """
    if room is None or len(rows) <= room:
        return Chosen(tuple(rows))
    urgent = [row for row in rows if row.mark != CALM]
    # Sorting is stable: what is equally urgent keeps its order.
    first = sorted(urgent, key=lambda row: _URGENCY.index(row.mark))
    ordered = [*first, *(row for row in rows if row.mark == CALM)]
    kept = ordered[: max(0, room - 1)]
    return Chosen(tuple(kept), len(ordered) - len(kept), max(0, len(first) - len(kept)))
