"""Conditions in the extensions of a part, each with its place in the file."""

from domain.conditions.condition import Condition
from domain.conditions.lexer import ConditionSyntaxError
from service.files.smh_block import SmhBlock, WrittenCondition
from service.files.source_text import SourceText
from service.files.yaml_tree import Scalar


def read_condition(
    block: SmhBlock, source: SourceText, where: str, text: str, place: Scalar
) -> Condition | None:
    """Return a condition, which is noted in its block; None after reporting that it is none.

    Args:
        block: Block of the part; receives findings.
        source: Text of the file.
        where: The place in words, for messages.
        text: The condition as it is written.
        place: Where it stands.
    """
    shift = len(text) - len(text.lstrip())
    try:
        condition = Condition.parse(text.strip())
    except ConditionSyntaxError as error:
        at = source.place(place, shift + error.column - 1)
        block.complain(at, error.code, f"{where}: {error.message}")
        return None
    block.conditions.append(WrittenCondition(block.name, where, condition, place, shift))
    return condition
