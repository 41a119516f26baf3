"""What commands of `pilothouse` write to a terminal, each in the same form."""

import sys
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # Not at run time: `--help` loads nothing of the core.
    from domain.findings import Finding


def complain(message: str) -> None:
    """Say on the standard error what went wrong."""
    # Where standard error takes nothing, the exit code is all that is left.
    with suppress(OSError):
        print(f"pilothouse: {message}", file=sys.stderr, flush=True)


def finding_line(file: str, finding: "Finding") -> str:
    """Return a finding as compilers write them: `file:line:column: severity CODE message`."""
    place = f"{file}:{finding.line or 1}:{finding.column or 1}"
    return f"{place}: {finding.severity} {finding.code} {finding.message}"


def counted(number: int, what: str) -> str:
    """Return a number of things: `1 error`, `2 errors`."""
    return f"{number} {what}" + ("" if number == 1 else "s")
