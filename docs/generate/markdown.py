"""The subset of Markdown that the pages use."""

from collections.abc import Iterable, Sequence

NOTE = "<!-- Generated from the code: edit docs/generate and run `python -m docs.generate`. -->"


def page(title: str, *blocks: str) -> str:
    """Return a whole page of blocks, separated by empty lines."""
    return "\n\n".join((f"# {title}", NOTE, *blocks)) + "\n"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; each row has as many cells as there are heads."""
    lines = [_row(heads), "|" + "---|" * len(heads)]
    lines += [_row(row) for row in rows]
    return "\n".join(lines)


def code(text: str) -> str:
    """Return text as code."""
    return f"`{text}`"


def joined(text: str) -> str:
    """Return multi-line text as one line."""
    return " ".join(text.split())


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"
