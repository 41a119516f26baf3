"""A model of any size in which every part has guards, an order and a fallback."""

from collections.abc import Iterator

from tests.support.big_model import big_model_text


def guarded_model_text(nodes: int) -> str:
    """Return the model of `big_model_text` with settings of each part, as YAML."""
    lines: list[str] = []
    for block in _blocks(big_model_text(nodes)):
        lines += [*block, *_settings(block)]
    return "\n".join([*lines, ""])


def _blocks(text: str) -> Iterator[list[str]]:
    """Yield the lines of each part."""
    block: list[str] = []
    for line in text.splitlines():
        if block and not line.startswith(" "):
            yield block
            block = []
        block.append(line)
    yield block


def _settings(block: list[str]) -> Iterator[str]:
    name = block[0].removesuffix(":")
    yield "    mode_settings:"
    yield "      FAST:"
    yield f'        requires: ["battery_level >= 0.3", "{name}.state != finalized"]'
    yield '        invariants: ["temperature < 60 and (battery_level > 0.1 or not error.GPS_LOST)"]'
    yield "        grace_s: 0.5"
    yield "        fallback: SLOW"
    listed = block[3].strip()
    if listed.startswith("parts: ["):
        first, *_, last = listed.removeprefix("parts: [").removesuffix("]").split(", ")
        yield f"        transition: {{after: {{{last}: [{first}]}}, on_failure: rollback}}"
