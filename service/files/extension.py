"""Extensions of SMH files: blocks beside `modes` of a part, which the C++ of system_modes ignores.

It ignores their meaning only: its YAML reader rejects what it cannot store, and it finds `modes.`
and `rules.` anywhere in a dotted name. What it would reject or misread is a warning, so that one
file serves both.

Source: ROS 2 `rcl_yaml_param_parser`, `parse.c`; micro-ROS system_modes, `mode_inference.cpp`
(`read_modes_from_model`) and `mode_handling.cpp` (`read_rules_from_model`).
"""

from collections.abc import Sequence as Entries
from dataclasses import dataclass

from domain.findings import Finding
from service.files.parameter_file import PARAMETERS_KEY, NodeParameters, scalar_value
from service.files.yaml_tree import (
    MAX_DEPTH,
    STRING_TAG,
    Mapping,
    Node,
    Scalar,
    Sequence,
    finding_at,
)

NAMES_OF_CPP = frozenset(("type", "parts", "modes", "rules"))
"""The keys of a part that system_modes knows; all others are extensions."""

MAX_SETTINGS = 10_000
"""Lines in the extensions of one part; with aliases, a small file can expand to many."""

_NOTHING = frozenset(("", "~", "null", "Null", "NULL"))
_MISREAD = ("modes", "rules")


@dataclass(frozen=True, slots=True)
class Setting:
    """One line of an extension."""

    path: tuple[str, ...]
    """Words of its dotted name, such as `mode_settings`, `FAST`, `grace_s`."""
    key: Scalar
    value: Scalar | Sequence | None
    """None: the line says nothing."""


def is_in_extension(keys: list[str]) -> bool:
    """Tell whether what is below these keys is in an extension of a part."""
    if PARAMETERS_KEY not in keys:
        return False
    below = keys[keys.index(PARAMETERS_KEY) + 1 :]
    return bool(below) and below[0] != "" and below[0].partition(".")[0] not in NAMES_OF_CPP


def is_nothing(value: Node | None) -> bool:
    """Tell whether a value is a null of YAML; system_modes has none."""
    if not isinstance(value, Scalar):
        return value is None
    is_plain = not value.is_quoted and value.tag != STRING_TAG
    return is_plain and value.text in _NOTHING


def read_extensions(source: NodeParameters) -> tuple[list[Setting], list[Finding]]:
    """Return the lines of all extensions of a part, and what the C++ would not read of them."""
    reader = _Reader(source.name)
    reader.read_all((), source.extensions, 1)
    return reader.settings, reader.findings


class _Reader:
    def __init__(self, part: str) -> None:
        self.settings: list[Setting] = []
        self.findings: list[Finding] = []
        self._part = part
        self._known: dict[tuple[str, ...], Scalar] = {}
        self._told: set[tuple[int, int]] = set()
        self._is_full = False

    def read_all(
        self, above: tuple[str, ...], entries: Entries[tuple[Scalar, Node | None]], depth: int
    ) -> None:
        """Read keys with all below them; aliases can make a tree deeper than its text."""
        for key, value in entries:
            if self._is_full:
                return
            path = (*above, *key.text.split("."))
            if any(word.endswith(_MISREAD) for word in path[len(above) :]):
                message = (
                    f"{key.text}: system_modes takes names that end in 'modes' or 'rules' for "
                    "its own; use another name"
                )
                self._warn(key, message)
            if not isinstance(value, Mapping):
                self._read_line(path, key, value)
            elif not value.entries:
                self._warn(key, f"{key.text} is an empty map, which ROS 2 rejects; leave it out")
                self._read_line(path, key, None)
            elif depth == MAX_DEPTH:
                self._stop(key, "TOO_DEEP", f"more than {MAX_DEPTH} levels of nested maps")
            else:
                self.read_all(path, value.entries, depth + 1)

    def _read_line(
        self, path: tuple[str, ...], key: Scalar, value: Scalar | Sequence | None
    ) -> None:
        if self._is_first(path, key):
            self._check(key, value)
            self.settings.append(Setting(path, key, None if is_nothing(value) else value))

    def _is_first(self, path: tuple[str, ...], key: Scalar) -> bool:
        """Tell whether a line is the first one of its name, and there is room for it."""
        first = self._known.setdefault(path, key)
        if first is not key:
            message = f"duplicate key {'.'.join(path)!r}; first in line {first.line}"
            self.findings.append(finding_at(key, "DUPLICATE_KEY", message, self._part))
            return False
        if len(self._known) > MAX_SETTINGS:
            message = f"more than {MAX_SETTINGS:,} lines beside the modes of {self._part}"
            self._stop(key, "TOO_LARGE", message)
            return False
        return True

    def _stop(self, key: Scalar, code: str, message: str) -> None:
        self.findings.append(finding_at(key, code, message, self._part))
        self._is_full = True

    def _check(self, key: Scalar, value: Scalar | Sequence | None) -> None:
        """Tell what the YAML reader of ROS 2 would not store."""
        if isinstance(value, Sequence):
            self._check_list(key, value)
        elif value is not None and is_nothing(value):
            message = f"{key.text} has no value; ROS 2 has no null; leave the key out"
            self._warn(value if value.text else key, message)

    def _check_list(self, key: Scalar, sequence: Sequence) -> None:
        items = [item for item in sequence.items if item is not None]
        if not items:
            self._warn(sequence, f"{key.text} is an empty list, which ROS 2 rejects; leave it out")
            return
        nested = next((item for item in items if not isinstance(item, Scalar)), None)
        if nested is not None:
            message = f"{key.text}: ROS 2 rejects lists of lists or maps; name the entries in a map"
            self._warn(nested, message)
            return
        first = type(scalar_value(items[0])) if isinstance(items[0], Scalar) else None
        for item in items:
            if isinstance(item, Scalar) and is_nothing(item):
                self._warn(item, f"{key.text}: ROS 2 has no null; leave the item out")
                return
            if isinstance(item, Scalar) and type(scalar_value(item)) is not first:
                message = (
                    f"{key.text}: ROS 2 rejects lists of several types; y, n, yes, no, on, off, "
                    "true and false are booleans unless quoted"
                )
                self._warn(item, message)
                return

    def _warn(self, place: Node, message: str) -> None:
        """Warn of a place once, however many aliases lead there."""
        if (place.line, place.column) in self._told:
            return
        self._told.add((place.line, place.column))
        self.findings.append(finding_at(place, "NOT_FOR_CPP", message, self._part, "warning"))
