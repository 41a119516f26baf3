"""Names of parts that conditions take for something else."""

from collections.abc import Iterator

from domain.conditions.tree import RESERVED_WORDS
from domain.findings import Finding
from domain.parts.lint.warning import warning
from domain.parts.system_model import SmhModel


def reserved_words(model: SmhModel) -> Iterator[Finding]:
    """Yield a warning for each part whose name is a word of conditions, if there are any."""
    if not model.has_conditions:
        return
    for part in model.parts:
        if part in RESERVED_WORDS:
            message = (
                f"{part} has another meaning in conditions; name the part as part('{part}') there"
            )
            yield warning("RESERVED_WORD", message, part)
