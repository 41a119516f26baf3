"""A condition as it stands in a file."""

from dataclasses import dataclass

MAX_LENGTH = 500
"""Characters of a condition."""


@dataclass(frozen=True, slots=True)
class Condition:
    """One line of text that compares facts about the robot."""

    text: str
