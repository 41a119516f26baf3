"""The whole picture, as lines that fit a terminal."""

from rich.console import Console
from rich.text import Text

from api.cli.monitor import blocks
from api.cli.monitor.lines import cut
from api.cli.monitor.part_block import PartBlock
from api.cli.monitor.rows import SignalRow, part_rows
from api.cli.monitor.view import Level, View

_LEAST = 3
"""Lines of a block that is cut."""
_NOTES = 5
_LOW = 10
"""Lines of a terminal below which the title alone is the head."""


def picture(view: View, console: Console, height: int | None = None) -> list[Text]:
    """Return the lines of the picture, none of them wider than the console.

    Args:
        view: What is drawn.
        console: Whose width is used; nothing is written to it.
        height: Most lines; None: as many as are needed, without recent events.
    """
    is_low = height is not None and height < _LOW
    top = [*blocks.head(view)[: 1 if is_low else None], *blocks.sentences(view, console)]
    if height is not None:
        top = cut(top, max(_LEAST, height // 2))
    lines = top if view.robot.parts is None else _joined(view, console, top, height)
    if view.contact.level is Level.LOST:
        for line in lines[len(top) :]:
            line.stylize("dim")
    for line in lines:
        line.truncate(console.width, overflow="ellipsis")
    return lines if height is None else lines[:height]


def _joined(view: View, console: Console, top: list[Text], height: int | None) -> list[Text]:
    """Distribute the lines: state and task come first, blank lines last."""
    robot, width = view.robot, console.width
    task = [] if robot.of_graph else blocks.task(view, console)
    parts = PartBlock(view, part_rows(robot.parts or {}), console)
    signals = [SignalRow(signal) for signal in (robot.signals or {}).values()]
    more = [*blocks.devices(view), *blocks.errors(view), *blocks.reactions(view)]
    if height is None:
        for_signals = None if signals else 0
        tables = parts.lines(None), blocks.signals(view, signals, width, for_signals)
        return _spaced(top, *tables, task, more)
    task = cut(task, max(_LEAST, height // 4))
    left = max(0, height - len(top) - len(task))
    for_parts, for_signals = _shares(parts.height, 1 + len(signals) if signals else 0, left)
    tables = parts.lines(for_parts), blocks.signals(view, signals, width, for_signals)
    spare = left - sum(map(len, tables))
    gaps = 1 + len(tables)
    if spare <= gaps:
        return [*top, *tables[0], *tables[1], *task, *more[:spare]]
    # With another gap in front of each.
    notes = blocks.notes(view, min(_NOTES, spare - gaps - 1 - len(more) - 1))
    return _spaced(top, *tables, task, notes, more if spare > gaps + len(more) else [])


def _shares(parts: int, signals: int, left: int) -> tuple[int, int]:
    """Return the lines for parts and for signals; if they are scarce, signals get a third."""
    if parts + signals <= left:
        return parts, signals
    for_signals = min(signals, max(left // 3, left - parts))
    return left - for_signals, for_signals


def _spaced(*pieces: list[Text]) -> list[Text]:
    """Return the pieces that are not empty, with an empty line between them."""
    lines: list[Text] = []
    for piece in pieces:
        if piece:
            lines += [Text(), *piece] if lines else piece
    return lines
