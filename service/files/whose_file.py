"""Whose record a robot file in a log is: all computers of a robot have the same robot file.

A replay has to make the core of the same computer again, so the log keeps the name of a device in
a comment above the file.
"""

from domain.computers import SUPERVISOR, ComputerName

_WORDS = "# read by the device "


def with_computer(text: str, computer: ComputerName) -> str:
    """Return a robot file as the log of a computer keeps it."""
    return text if computer == SUPERVISOR else f"{_WORDS}{computer}\n{text}"


def computer_of(text: str) -> ComputerName:
    """Return whose log kept a robot file."""
    first = text.partition("\n")[0]
    return ComputerName(first.removeprefix(_WORDS)) if first.startswith(_WORDS) else SUPERVISOR
