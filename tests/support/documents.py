"""Reads the blocks of a page in Markdown: commands, what they print, and files.

A comment right before a block says what a reader sees from the text around it:

    <!-- not run: REASON -->   the command is only looked at
    <!-- refused -->           the service refuses what is asked, as the page wants to show
    <!-- ends with 1 -->       the exit code; without it 0
    <!-- numbers vary -->      the numbers in the output are examples
    <!-- file: NAME -->        the block is a file, written before what follows
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

_FENCE = re.compile(r"^( *)```(\w*)\s*$")
_COMMENT = re.compile(r"^ *<!-- (.+?) -->\s*$")
_COMMAND = re.compile(r"(?:curl|docker|make|pilothouse|\.venv/bin/\S+) ")


@dataclass(frozen=True, slots=True)
class Block:
    """One block of a page."""

    page: Path
    line: int
    """Of its first line, from 1."""
    language: str
    text: str
    marks: dict[str, str] = field(default_factory=dict)
    follows: bool = False
    """Nothing but comments and empty lines is between it and the block before."""

    @property
    def is_command(self) -> bool:
        """Tell whether it is for the shell."""
        return self.language == "sh" and "file" not in self.marks

    @property
    def is_output(self) -> bool:
        """Tell whether it shows what the command before it prints."""
        return self.follows and self.language in ("json", "text") and "file" not in self.marks

    def __str__(self) -> str:
        return f"{self.page.name}:{self.line}"


def read_blocks(page: Path) -> list[Block]:
    """Return the blocks of a page; indented ones are those that hold commands."""
    return list(_blocks(page, page.read_text(encoding="utf-8").splitlines()))


def _blocks(page: Path, lines: list[str]) -> Iterator[Block]:
    marks: dict[str, str] = {}
    number, follows = 0, False
    while number < len(lines):
        line = lines[number]
        begin = number + 1
        if fence := _FENCE.match(line):
            end = next(n for n in range(begin, len(lines)) if lines[n].strip() == "```")
            text = "\n".join(part.removeprefix(fence[1]) for part in lines[begin:end])
            yield Block(page, begin + 1, fence[2], text, marks, follows)
            number, marks, follows = end + 1, {}, True
        elif _begins_indented(lines, number):
            end = begin
            while end < len(lines) and (lines[end].startswith("    ") or not lines[end].strip()):
                end += 1
            text = "\n".join(part.removeprefix("    ") for part in lines[number:end]).strip()
            language = "sh" if _COMMAND.match(text) else ""
            yield Block(page, begin, language, text, marks, follows)
            number, marks, follows = end, {}, True
        else:
            if comment := _COMMENT.match(line):
                name, _, value = comment[1].partition(": ")
                marks = {**marks, name: value}
            elif line.strip():
                marks, follows = {}, False
            number += 1


def _begins_indented(lines: list[str], number: int) -> bool:
    is_first = number == 0 or not lines[number - 1].strip() or _COMMENT.match(lines[number - 1])
    return lines[number].startswith("    ") and bool(is_first)
