"""What commands of `pilothouse` write to a terminal, each in the same form."""

import sys
import unicodedata
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # Not at run time: `--help` loads nothing of the core.
    from domain.findings import Finding

_HIDDEN = frozenset(("Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"))


def complain(message: str) -> None:
    """Say on the standard error what went wrong."""
    # Where standard error takes nothing, the exit code is all that is left.
    with suppress(OSError):
        text = "\n".join(map(visible, message.splitlines()))
        print(f"pilothouse: {text}", file=sys.stderr, flush=True)


def say(line: str) -> None:
    """Print a line at once, also into a pipe; nothing in it can steer the terminal."""
    print(visible(line), flush=True)


def finding_line(file: str, finding: "Finding") -> str:
    """Return a finding as compilers write them: `file:line:column: severity[CODE]: message`."""
    place = f"{file}:{finding.line or 1}:{finding.column or 1}"
    return visible(f"{place}: {finding.severity}[{finding.code}]: {finding.message}")


def visible(text: str) -> str:
    """Return a text with escapes for characters that steer a terminal or hide others."""
    return "".join(escape(character) if is_hidden(character) else character for character in text)


def is_hidden(character: str) -> bool:
    """Tell whether a character is a control character, or prints nothing, but is no mark."""
    return unicodedata.category(character) in _HIDDEN


def escape(character: str) -> str:
    r"""Return a character as Python writes it in a text, such as `\x1b`."""
    return character.encode("unicode_escape").decode("ascii")


def counted(number: int, what: str) -> str:
    """Return a number of things: `1 error`, `2 errors`."""
    return f"{number} {what}" + ("" if number == 1 else "s")
