"""The meaning of one code."""

from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

CodeSeverity: TypeAlias = Literal["error", "warning", "error or warning"]

ERROR: Final = "error"
WARNING: Final = "warning"
EITHER: Final = "error or warning"


@dataclass(frozen=True, slots=True)
class FindingCode:
    """What a code means, in Markdown of one line each."""

    code: str
    severity: CodeSeverity
    meaning: str
    mend: str
    """What to do about it."""
