"""Compares the expectations of a scenario with the simulated robot, and lists differences."""

from collections.abc import Iterator, Mapping
from typing import Any

from api.http.schemas.sent_values import split_label
from api.http.schemas.simulation import DifferenceJson

MISSING = "(not there)"
"""Shown as the value of a missing member."""


def differences(expected: object, seen: object, path: str = "") -> Iterator[DifferenceJson]:
    """Yield each member that differs from what is expected.

    Of an object, only the expected members are compared. A number may be given by limits:
    `{"above": 0.5}`, `{"at_least": 3, "at_most": 5}`, `{"below": 1}`. A state with its mode may be
    given as a label: `"active.FAST"`.

    Args:
        expected: From the scenario.
        seen: The actual value, as in JSON.
        path: Place of both, with dots.
    """
    if isinstance(expected, Mapping) and _is_limits(expected):
        if not _within(expected, seen):
            yield DifferenceJson(path=path, expected=dict(expected), seen=seen)
    elif isinstance(expected, Mapping) and isinstance(seen, Mapping):
        for name, value in expected.items():
            inner = f"{path}.{name}" if path else str(name)
            if name not in seen:
                yield DifferenceJson(path=inner, expected=value, seen=MISSING)
            else:
                yield from differences(value, seen[name], inner)
    elif isinstance(expected, str) and isinstance(seen, Mapping) and "state" in seen:
        wanted = split_label(expected)
        if wanted != {"state": seen["state"], "mode": seen.get("mode")}:
            yield DifferenceJson(path=path, expected=expected, seen=_label(seen))
    elif expected != seen or isinstance(expected, bool) is not isinstance(seen, bool):
        yield DifferenceJson(path=path, expected=expected, seen=seen)


_LIMITS = frozenset({"above", "below", "at_least", "at_most"})


def _is_limits(expected: Mapping[str, Any]) -> bool:
    return bool(expected) and expected.keys() <= _LIMITS and all(map(_is_number, expected.values()))


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _within(limits: Mapping[str, Any], seen: object) -> bool:
    if not isinstance(seen, int | float) or isinstance(seen, bool):
        return False
    return not (
        ("above" in limits and seen <= limits["above"])
        or ("below" in limits and seen >= limits["below"])
        or ("at_least" in limits and seen < limits["at_least"])
        or ("at_most" in limits and seen > limits["at_most"])
    )


def _label(seen: Mapping[str, Any]) -> str:
    mode = seen.get("mode")
    return f"{seen['state']}.{mode}" if mode else str(seen["state"])
