"""Tables of cases whose rows can be read, and whose ids are sentences."""

from collections.abc import Mapping

import pytest


def table(rows: Mapping[str, object]) -> pytest.MarkDecorator:
    """Run a test, which takes a `row`, for each of these; the keys are the ids.

    A row with several values is best a `NamedTuple` whose fields are named in the table.
    """
    cases = [pytest.param(row, id=sentence) for sentence, row in rows.items()]
    return pytest.mark.parametrize("row", cases)


def text_table(text: str) -> pytest.MarkDecorator:
    """Run a test for each row of a table of words, with one argument a column.

    Args:
        text: The first line names the columns, and spaces in it become `_` in the argument. Cells
            are parted by `|`. Empty lines and those that begin with `#` are for the reader.
    """
    stripped = (line.strip() for line in text.splitlines())
    lines = [line for line in stripped if line and not line.startswith("#")]
    heads, *rows = [[cell.strip() for cell in line.split("|")] for line in lines]
    cases = [
        pytest.param(*row, id=", ".join(map(" ".join, zip(heads, row, strict=True))))
        for row in rows
    ]
    return pytest.mark.parametrize([head.replace(" ", "_") for head in heads], cases)
