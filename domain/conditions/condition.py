"""A condition as it stands in a file."""

from dataclasses import dataclass, field

from domain.conditions.parser import parse
from domain.conditions.tree import Node


@dataclass(frozen=True, slots=True)
class Condition:
    """One line of text that compares facts about the robot; equal to others of the same text.

    Raises:
        ConditionSyntaxError: The text cannot be read as a condition.
    """

    text: str
    root: Node = field(init=False, repr=False, compare=False)
    """What it compares."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "root", parse(self.text))

    @classmethod
    def parse(cls, text: str) -> "Condition":
        """Return the condition that a text holds.

        Raises:
            ConditionSyntaxError: It holds none.
        """
        return cls(text)
