"""Compares what a page shows with what a command printed."""

import json
import re
from collections.abc import Iterator
from typing import Any

# Different each time by what they are.
VARYING = re.compile(r"seq|at|\w+_at|cause|epoch|actor|by")


def last_json(printed: str) -> Any:  # noqa: ANN401
    """Return the last of the documents among what commands printed."""
    decoder, found, at = json.JSONDecoder(), None, printed.find("{")
    while at >= 0:
        try:
            found, end = decoder.raw_decode(printed, at)
        except json.JSONDecodeError:
            # A brace in the words of another command.
            end = at + 1
        at = printed.find("{", end)
    return found


def disagreement(shown: Any, seen: Any, *, vary: bool, where: str = "") -> str | None:  # noqa: ANN401
    """Return where a document differs from the part of it that a page shows; None: nowhere.

    Args:
        shown: `"..."` stands for anything, at the end of a list for what follows.
        seen: What was printed.
        vary: Numbers are examples.
        where: Path to here.
    """
    if shown == "...":
        return None
    if isinstance(shown, dict) and isinstance(seen, dict):
        return _first(
            disagreement(value, seen.get(key, "nothing"), vary=vary, where=f"{where}/{key}")
            for key, value in shown.items()
            if not VARYING.fullmatch(key) or key not in seen
        )
    if isinstance(shown, list) and isinstance(seen, list):
        is_open = shown[-1:] == ["..."]
        items = shown[:-1] if is_open else shown
        if len(items) > len(seen) or (len(items) < len(seen) and not is_open):
            return f"{where}: {len(seen)} items"
        return _first(
            disagreement(item, seen[number], vary=vary, where=f"{where}/{number}")
            for number, item in enumerate(items)
        )
    if vary and _is_number(shown) and _is_number(seen):
        return None
    if isinstance(shown, str) and "..." in shown and isinstance(seen, str):
        return None if like(shown).fullmatch(seen) else f"{where}: {seen!r}"
    return None if shown == seen else f"{where}: {seen!r}"


def missing_lines(shown: str, printed: str, *, vary: bool) -> list[str]:
    """Return the lines of a page that were not printed in this order, the first one first."""
    wanted = [line.rstrip() for line in shown.splitlines() if line.strip() not in ("", "...")]
    left = iter(printed.splitlines())
    return [
        line
        for line in wanted
        if not any(like(line, vary=vary).fullmatch(seen.rstrip()) for seen in left)
    ]


def like(shown: str, *, vary: bool = False) -> re.Pattern[str]:
    """Return what a text with `...` matches."""
    pattern = re.escape(shown).replace(re.escape("..."), ".*")
    if vary:
        pattern = re.sub(r"(?:\\ )*\d+(?:\\\.\d+)?", r" *\\d+(?:\\.\\d+)?", pattern)
    return re.compile(pattern)


def _first(found: Iterator[str | None]) -> str | None:
    return next((text for text in found if text is not None), None)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
