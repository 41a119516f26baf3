"""Errors as lines of text: roots first, and below each what follows from it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, TypeAlias

Json: TypeAlias = Mapping[str, Any]

SEVERITIES = ("fatal", "critical", "urgent", "warning")
_ON = frozenset({"active", "acknowledged", "latched"})
_STATES = ("active", "latched", "acknowledged", "pending", "returned", "normal")
"""What needs somebody first."""


def error_name(item: Json) -> str:
    """Return the name of an error among all, such as `BATTERY_LOW` or `lidar.SILENT`."""
    return str(item["error"]) if item["part"] is None else f"{item['part']}.{item['error']}"


def is_on(item: Json) -> bool:
    """Tell whether an error is on."""
    return item["state"] in _ON


def is_silenced(item: Json) -> bool:
    """Tell whether an error is shelved or suppressed, and so not announced."""
    return bool(item["suppressed"]) or item["shelved_until_at"] is not None


def is_pressing(item: Json) -> bool:
    """Tell whether somebody has to attend to an error soon, and it follows from no other."""
    is_root = bool(item["root_cause"])
    return is_on(item) and is_root and item["severity"] != "warning" and not is_silenced(item)


def error_lines(items: Sequence[Json]) -> Iterator[str]:
    """Yield a line for each error, what is silenced last.

    Args:
        items: Errors as in `GET /errors`.
    """
    loud = [item for item in items if not is_silenced(item)]
    silenced = [item for item in items if is_silenced(item)]
    yield from _tree(loud)
    if silenced:
        yield f"not announced ({len(silenced)}):"
        for item in sorted(silenced, key=_urgency):
            yield f"  {_line(item)}"


def _tree(items: Sequence[Json]) -> Iterator[str]:
    """Yield roots, each with its consequences indented below it."""
    names = {error_name(item) for item in items if item["root_cause"]}
    below: dict[str | None, list[Json]] = {}
    for item in items:
        roots = [] if item["root_cause"] else [error_name(root) for root in item["roots"]]
        found = next((root for root in roots if root in names), None)
        below.setdefault(found, []).append(item)
    for item in sorted(below.get(None, []), key=_urgency):
        yield _line(item)
        consequences = below.get(error_name(item), []) if item["root_cause"] else []
        for consequence in sorted(consequences, key=_urgency):
            yield f"  {_line(consequence)}"


def _urgency(item: Json) -> tuple[int, int, str]:
    """Return where an error stands: by what it needs, how bad it is, and since when."""
    state, severity = _STATES.index(item["state"]), SEVERITIES.index(item["severity"])
    return (not is_on(item)) * len(_STATES) + state, severity, item["since_at"] or ""


def _line(item: Json) -> str:
    message = f": {item['message']}" if item["message"] else ""
    marks = "".join(f"  [{mark}]" for mark in _marks(item))
    return f"{item['state']:<12}  {item['severity']:<8}  {error_name(item)}{message}{marks}"


def _marks(item: Json) -> Iterator[str]:
    if item["first_out"] and is_on(item):
        yield "first"
    if item["since_at"]:
        yield f"since {item['since_at']}"
    if item["count"] > 1:
        yield f"{item['count']} times"
    if item["shelved_until_at"] is not None:
        yield f"shelved until {item['shelved_until_at']}: {item['shelved_because']}"
    if item["suppressed"]:
        yield "suppressed"
    if item["hint"]:
        yield str(item["hint"])
