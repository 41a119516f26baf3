"""Places inside scalars: which character of a file a character of a value is."""

import re
from functools import cached_property

from service.files.yaml_tree import Scalar, lines_of_yaml

# An anchor or a tag before the value.
_PROPERTIES = re.compile(r"(?:[&!]\S*\s+)*")
_ESCAPE = re.compile(r"\\(?:x[0-9a-fA-F]{2}|u[0-9a-fA-F]{4}|U[0-9a-fA-F]{8}|.)")


class SourceText:
    """The text of a YAML file."""

    def __init__(self, text: str) -> None:
        self._text = text

    def place(self, scalar: Scalar, index: int) -> Scalar:
        """Return the place of a character of a scalar.

        Exact where the scalar is on one line, quoted or not; that of the scalar where it is folded
        or in a block.

        Args:
            scalar: From this text.
            index: Of the character in the value, from 0; at most its length.
        """
        if scalar.line > len(self._lines):
            return scalar
        line = self._lines[scalar.line - 1]
        start = scalar.column - 1
        properties = _PROPERTIES.match(line, start)
        start = properties.end() if properties is not None else start
        if scalar.is_quoted:
            column = _in_quotes(line, start, index)
        else:
            column = start + index if line.startswith(scalar.text, start) else None
        return scalar if column is None else Scalar(scalar.line, column + 1, "")

    @cached_property
    def _lines(self) -> list[str]:
        return lines_of_yaml(self._text)


def _in_quotes(line: str, start: int, index: int) -> int | None:
    """Return where a character stands in a line, from 0; None: not on this line."""
    quote = line[start : start + 1]
    at = start + 1
    for _ in range(index):
        at = _after_character(line, at, quote)
    return at if at < len(line) else None


def _after_character(line: str, at: int, quote: str) -> int:
    """Return where the next character of a quoted scalar stands."""
    if quote == "'":
        return at + (2 if line.startswith("''", at) else 1)
    escape = _ESCAPE.match(line, at)
    return escape.end() if escape is not None else at + 1
