"""Standard input, output and error: also where whoever started the command closed or broke them."""

import os
import sys
from typing import Literal, TextIO


def open_missing() -> None:
    """Put the null device in the place of standard files that are closed.

    Otherwise the next file or socket that is opened gets the number of one, and what is printed
    goes there.
    """
    for number, mode in enumerate((os.O_RDONLY, os.O_WRONLY, os.O_WRONLY)):
        try:
            os.fstat(number)
        except OSError:
            # The lowest free number is taken: this one.
            os.open(os.devnull, mode)
    sys.stdin = sys.stdin or _stream(0, "r")
    sys.stdout = sys.stdout or _stream(1, "w")
    sys.stderr = sys.stderr or _stream(2, "w")


def give_up_output() -> None:
    """Discard what was not written, so that the interpreter does not try again at its end."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, sys.stdout.fileno())
    os.close(null)


def _stream(number: int, mode: Literal["r", "w"]) -> TextIO:
    # Open as long as the process is.
    return open(number, mode, encoding="utf-8", closefd=False)
