"""The whole picture, as lines that fit a terminal."""

from rich.console import Console
from rich.text import Text

from api.cli.monitor import blocks
from api.cli.monitor.rows import SignalRow, part_rows
from api.cli.monitor.view import Level, View

_LEAST = 3
"""Lines of a block that is cut."""
_NOTES = 5


def picture(view: View, console: Console, height: int | None = None) -> list[Text]:
    """Return the lines of the picture, none of them wider than the console.

    Args:
        view: What is drawn.
        console: Whose width is used; nothing is written to it.
        height: Most lines; None: as many as are needed, without recent events.
    """
    top = [*blocks.head(view, console.width), *blocks.sentences(view, console)]
    if height is not None:
        top = _cut(top, max(_LEAST, height // 2))
    lines = top if view.robot.system_state is None else _joined(view, console, top, height)
    if view.contact.level is Level.LOST:
        for line in lines[len(top) :]:
            line.stylize("dim")
    for line in lines:
        line.truncate(console.width, overflow="ellipsis")
    return lines if height is None else lines[:height]


def _joined(view: View, console: Console, top: list[Text], height: int | None) -> list[Text]:
    """Distribute the lines: state and task come first, blank lines last."""
    task = blocks.task(view, console)
    parts = part_rows(view.robot.parts or {})
    signals = [SignalRow(signal) for signal in (view.robot.signals or {}).values()]
    legend = [
        *blocks.devices(view),
        *blocks.errors(view),
        *blocks.reactions(view),
        Text(blocks.LEGEND),
    ]
    if height is None:
        return _spaced(
            top,
            blocks.parts(view, parts, console.width, None),
            blocks.signals(view, signals, console.width, None),
            task,
            legend,
        )
    task = _cut(task, max(_LEAST, height // 4))
    left = max(0, height - len(top) - len(task))
    for_parts, for_signals = _shares(1 + len(parts), 1 + len(signals), left)
    tables = (
        blocks.parts(view, parts, console.width, for_parts),
        blocks.signals(view, signals, console.width, for_signals),
    )
    spare = left - sum(map(len, tables))
    gaps = 1 + len(tables)
    if spare <= gaps:
        return [*top, *tables[0], *tables[1], *task, *legend[:spare]]
    # With another gap in front of each.
    notes = blocks.notes(view, min(_NOTES, spare - gaps - 1 - len(legend) - 1))
    return _spaced(top, *tables, task, notes, legend if spare > gaps + len(legend) else [])


def _shares(parts: int, signals: int, left: int) -> tuple[int, int]:
    """Return the lines for parts and for signals; if they are scarce, signals get a third."""
    if parts + signals <= left:
        return parts, signals
    for_signals = min(signals, max(left // 3, left - parts))
    return left - for_signals, for_signals


def _cut(lines: list[Text], most: int) -> list[Text]:
    if len(lines) <= most:
        return lines
    return [*lines[: most - 1], Text(f"  ... and {len(lines) - most + 1} more lines")]


def _spaced(*pieces: list[Text]) -> list[Text]:
    """Return the pieces that are not empty, with an empty line between them."""
    lines: list[Text] = []
    for piece in pieces:
        if piece:
            lines += [Text(), *piece] if lines else piece
    return lines
