"""The table of systems and nodes, and beneath it what there is to say about single parts.

Columns, header and sections are those of the mode monitor of system_modes (micro-ROS deliverable
D4.8, section 6.2): each part has target and actual of its state and of its mode.
"""

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from api.cli.monitor import words
from api.cli.monitor.device_words import heard_last
from api.cli.monitor.lines import counted, wrapped
from api.cli.monitor.rows import CHANGES, MARK_STYLES, UNREACHABLE, WRONG, PartRow, choose
from api.cli.monitor.store import Json
from api.cli.monitor.table import Column, Layout, printable
from api.cli.monitor.view import View

LEGEND = "(*) = inferred   ! deviation or error   > changing or pending   x unreachable"

_TARGETS_FROM = 54
"""Width of the table, in cells, from which targets have a column."""
_TITLES_OF = ("", "target", "actual", "target", "actual")
_LEAST = (10, 8, 8, 6, 6)
_USUAL = (25, 15, 15, 15, 15)
"""Widths of the columns in D4.8."""
_USUAL_OF_80 = (14, 12, 15, 11, 14)
"""Widths in a terminal of 80 cells, where the usual names keep their places."""
_ABOVE = (("part", (0,)), ("state", (1, 2)), ("mode", (3, 4)))
"""The titles above those of the columns, with the places of their columns."""
_GAP = " | "
_NO_MARK = "  "
_TITLES = 2
"""Lines of titles."""
_LEAST_LINES = _TITLES + 1
_WITH_SECTIONS = 8
"""Lines from which a table that is too long keeps its sections."""
_NOTE_SHARE = 3
"""A table that is too long leaves at most this part of its lines for notes."""


class PartBlock:
    """Systems and nodes as lines."""

    def __init__(self, view: View, rows: Sequence[PartRow], console: Console) -> None:
        """Prepare.

        Args:
            view: What is drawn.
            rows: A row for each part, systems first.
            console: Whose width is used.
        """
        self._view = view
        self._rows = rows
        self._console = console
        self._notes = {row.name: note for row in rows if (note := _note(view, row))}

    @property
    def height(self) -> int:
        """Return how many lines the whole block has, if no note needs several."""
        sections = len({row.is_system for row in self._rows})
        return _TITLES + sections + len(self._rows) + 2 + len(self._notes)

    def lines(self, room: int | None) -> list[Text]:
        """Return the lines.

        Args:
            room: Most lines; None: as many as needed. If not all parts fit, those that need
                attention come first, and the others are counted.
        """
        if room is None:
            return [*self._table(self._rows, ends=True), *self._note_lines(self._rows, wrap=True)]
        if room < _LEAST_LINES:
            return []
        if self.height <= room:
            return [*self._table(self._rows, ends=True), *self._note_lines(self._rows)]
        has_sections = room >= _WITH_SECTIONS
        body = room - _TITLES - (len({row.is_system for row in self._rows}) * has_sections)
        for_notes = min(len(self._notes), body // _NOTE_SHARE)
        chosen = choose(self._rows, body - for_notes)
        shown = sorted(chosen.rows, key=lambda row: not row.is_system)
        notes = self._note_lines(chosen.rows)
        return [
            *self._table(shown, sections=has_sections),
            *counted(chosen, "parts"),
            *notes[:for_notes],
        ]

    def _table(
        self, rows: Sequence[PartRow], *, sections: bool = True, ends: bool = False
    ) -> list[Text]:
        """Return titles and rows, by sections, and with the line and the legend at the end."""
        cells = [_cells(row) for row in rows]
        room = self._console.width - len(_NO_MARK)
        layout = Layout(_columns(room), [_TITLES_OF, *cells], room, _GAP)
        width = len(_NO_MARK) + layout.width
        lines = [_behind(_NO_MARK, layout.spanning(_ABOVE, "bold"))]
        lines.append(_behind(_NO_MARK, layout.line(_TITLES_OF)))
        section = ""
        for row, of_row in zip(rows, cells, strict=True):
            if sections and section != (section := "systems" if row.is_system else "nodes"):
                lines.append(Text(f"- {section} ".ljust(width, "-"), style="bold"))
            lines.append(_behind(f"{row.mark} ", layout.line(of_row, MARK_STYLES[row.mark])))
        if ends:
            lines += [Text("-" * width), Text(f" {LEGEND}")]
        return lines

    def _note_lines(self, rows: Sequence[PartRow], *, wrap: bool = False) -> list[Text]:
        lines: list[Text] = []
        for row in rows:
            note = self._notes.get(row.name)
            if note is None:
                continue
            text = f"{row.mark} {row.name}: {note}"
            said = wrapped(text, self._console, indent=4) if wrap else [Text(printable(text))]
            for line in said:
                line.style = MARK_STYLES[row.mark]
            lines += said
        return lines


def _columns(room: int) -> list[Column]:
    is_wide = room >= sum(_USUAL) + len(_GAP) * (len(_USUAL) - 1)
    usual = _USUAL if is_wide else _USUAL_OF_80
    return [
        Column(title, least, most, _TARGETS_FROM if title == "target" else 0, is_right=True)
        for title, least, most in zip(_TITLES_OF, _LEAST, usual, strict=True)
    ]


def _behind(mark: str, line: Text) -> Text:
    return Text(mark, style=line.style).append_text(line)


def _cells(row: PartRow) -> tuple[str, ...]:
    part = row.part
    actual, target = part["actual"], part["effective_target"] or part["target"] or {}
    is_known = actual["state"] != "unknown"
    device = part.get("device")
    return (
        f"{row.name} ({device})" if device else row.name,
        target.get("state") or "",
        words.starred(actual["state"], inferred=actual["inferred"]) if is_known else words.UNKNOWN,
        target.get("mode") or "",
        words.starred(actual["mode"] or "", inferred=actual["mode_inferred"]),
    )


def _note(view: View, row: PartRow) -> str:
    """Return what the columns of a part do not show; empty: nothing."""
    said = (_deviation(view, row), words.setter_and_reason(row.part["effective_target"]))
    return ", ".join(filter(None, said))


def _deviation(view: View, row: PartRow) -> str:
    part, since = row.part, row.part["deviation_since_at"]
    if row.mark == UNREACHABLE:
        return _away_words(view, part)
    for_time = "" if since is None else f" {words.duration(view.known_for_s(since))}"
    if row.mark == CHANGES:
        return f"changing{for_time}"
    reason = part["actual"]["reason"]
    if reason:
        return str(reason)
    if row.mark != WRONG:
        return ""
    # What a part itself deviates from is in its columns; which of its parts deviates is not.
    elsewhere = part.get("deviation_reason")
    is_own = not elsewhere or elsewhere.startswith(f"{row.name} is ")
    return f"deviates{for_time}" if is_own else f"deviates{for_time}: {elsewhere}"


def _away_words(view: View, part: Json) -> str:
    """Return that a node is unreachable; with what was known last, where its device is away."""
    heard = heard_last(view.robot.devices.get(part.get("device") or ""))
    if heard is None:
        return "unreachable"
    known, age = part.get("last_known"), words.duration(view.known_for_s(heard))
    return f"was {words.label(known)} {age} ago" if known else f"unreachable for {age}"
