"""The block `errors` of a part: what its errors mean, how they are found and what causes them."""

import re
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from types import MappingProxyType
from typing import Any, TypeAlias

from domain.conditions.condition import Condition
from domain.errors import near_match, shortened
from domain.findings import Finding
from domain.health.built_in_errors import ALL_OF_NODES, OF_EVERY_PART
from domain.health.signals import ESTOP
from domain.parts.declared_errors import DeclaredError
from domain.snapshot import ErrorKey, Severity
from domain.state_and_mode import part_name
from service.files.extension import Setting
from service.files.setting_values import InvalidSettingError, SettingValues
from service.files.smh_block import ERRORS, SmhBlock, WrittenCause
from service.files.smh_condition import read_condition
from service.files.source_text import SourceText
from service.files.yaml_tree import Scalar

MAX_CAUSES = 1_000
"""Causes of one error."""
MAX_TEXT = 500
"""Characters of a message or a hint."""

_NAME = re.compile(r"[A-Z][A-Z0-9_]{0,63}")
_CAUSE = re.compile(r"(?:(?P<part>[^.]+)\.)?(?P<error>[A-Z][A-Z0-9_]{0,63})")
_SEVERITIES = tuple(map(str, Severity))
_RECOVERIES = ("automatic", "acknowledge")
_NEEDS = ("any", "all")
_BUILT_IN_KEYS = frozenset(
    ("caused_by", "expected_within_s", "severity", "recovery", "suppressed_when", "hint")
)
"""What may be said about an error that parts have anyway."""


def read_errors(block: SmhBlock, source: SourceText) -> Mapping[str, DeclaredError]:
    """Read the errors that a part declares.

    Args:
        block: Block of the part; receives findings.
        source: Text of the file.
    """
    lines: dict[str, list[Setting]] = {}
    for setting in block.errors:
        if len(setting.path) > 1:
            lines.setdefault(setting.path[1], []).append(setting)
        elif setting.value is not None:
            message = f"{ERRORS} of {block.name}: expected errors below it"
            block.complain(setting.key, "NOT_A_BLOCK", message)
    built_in = ALL_OF_NODES if block.is_node else OF_EVERY_PART
    declared = {}
    for name, of_error in lines.items():
        reader = _Reader(block, source, name, is_built_in=name in built_in)
        if (read := reader.read(of_error)) is not None:
            declared[name] = read
    return declared


_Written: TypeAlias = dict[str, Any]
"""Values by field of `DeclaredError`."""


class _Reader:
    """Reads one error."""

    def __init__(
        self, block: SmhBlock, source: SourceText, name: str, *, is_built_in: bool
    ) -> None:
        self._block = block
        self._source = source
        self._name = name
        self._is_built_in = is_built_in
        self._where = f"{ERRORS} of {block.name}, {shortened(name)}"
        self._values = SettingValues(block)
        self._unknown: set[str] = set()
        """Keys that were reported."""

    def read(self, lines: Iterable[Setting]) -> DeclaredError | None:
        """Return what the lines say; None: its name cannot be used."""
        written: _Written = {}
        keys: dict[str, Scalar] = {}
        if not self._is_named():
            return None
        for line in lines:
            with suppress(InvalidSettingError):
                self._read_line(line, written, keys)
        declared = replace(DeclaredError(), **written)
        self._tell_what_has_no_effect(declared, keys)
        return declared

    def _is_named(self) -> bool:
        if _NAME.fullmatch(self._name) is None:
            message = (
                f"{self._where}: names of errors are capital letters, digits and underscores, "
                "and begin with a letter; at most 64 characters"
            )
            self._complain("INVALID_ERROR_NAME", message)
            return False
        if self._name == ESTOP:
            message = f"{self._where}: only the emergency stop of the robot has this name"
            self._complain("NAME_TAKEN", message)
            return False
        return True

    def _read_line(self, line: Setting, written: _Written, keys: dict[str, Scalar]) -> None:
        """Read one line.

        Raises:
            InvalidSettingError: It cannot be used.
        """
        if len(line.path) == 2:
            if line.value is not None:
                self._values.reject(line.key, f"{self._where}: expected keys below it")
            return
        key = line.path[2]
        if key not in _KEYS:
            self._complain_of_key(key)
        elif len(line.path) > 3:
            self._values.reject(line.key, f"{self._where}, {key}: expected no keys below it")
        elif self._is_built_in and key not in _BUILT_IN_KEYS:
            message = (
                f"{self._where}: parts have this error anyway, and only "
                f"{', '.join(sorted(_BUILT_IN_KEYS))} of it can be set, not {key}"
            )
            self._values.reject(line.key, message, "BUILT_IN_ERROR")
        elif line.value is not None:
            keys[key] = line.key
            field, read = _KEYS[key]
            written[field] = read(self, line, f"{self._where}, {key}")

    def _tell_what_has_no_effect(self, own: DeclaredError, keys: Mapping[str, Scalar]) -> None:
        is_found = own.when is not None or self._is_built_in
        idle: dict[str, str] = {}
        if own.when is None:
            idle |= dict.fromkeys(("for_s", "clear_for_s"), "without a condition in when")
        if is_found or not own.caused_by:
            why = "it is found by itself" if is_found else "it has no caused_by"
            idle |= dict.fromkeys(("need", "unless", "after_s"), f"since {why}")
        if not own.caused_by:
            idle["expected_within_s"] = "without caused_by"
        elif not is_found:
            idle["expected_within_s"] = "since it follows from its causes anyway"
        for key, place in keys.items():
            if key in idle and key in keys:
                message = f"{self._where}: {key} has no effect {idle[key]}"
                self._block.warn(place, "NO_EFFECT", message)

    def _complain_of_key(self, key: str) -> None:
        """Report a key that means nothing, once for all that is below it."""
        if key in self._unknown:
            return
        self._unknown.add(key)
        near = near_match(key, tuple(_KEYS))
        hint = f"did you mean {near}?" if near else f"known: {', '.join(_KEYS)}"
        message = f"{self._where}: unknown key {shortened(key)!r}; {hint}"
        self._complain("UNKNOWN_KEY", message, key)

    def _complain(self, code: str, message: str, *keys: str) -> None:
        """Report an error at the error that is declared, or at a key of it."""
        part = self._block.name
        path = (part, ERRORS, self._name, *keys)
        self._block.findings.append(Finding("error", code, message, part, path))

    # --- values ----------------------------------------------------------------------------------

    def condition(self, line: Setting, where: str) -> Condition:
        """Return a condition; one that cannot be read is reported."""
        text, place = self._values.text(line, where)
        condition = read_condition(self._block, self._source, where, text, place)
        if condition is None:
            raise InvalidSettingError
        return condition

    def causes(self, line: Setting, where: str) -> tuple[ErrorKey, ...]:
        """Return the errors of a list, after reporting each name that cannot be one."""
        causes: dict[ErrorKey, None] = {}
        for text, place in self._values.texts(line, where, MAX_CAUSES):
            found = _CAUSE.fullmatch(text.strip())
            if found is None:
                message = (
                    f"{where}: {shortened(text)!r} is no error; write PART.ERROR, or ERROR of "
                    "the robot itself"
                )
                self._block.complain(place, "INVALID_VALUE", message)
                continue
            part, error = found["part"], found["error"]
            cause = ErrorKey(None if part is None else part_name(part), error)
            if cause in causes:
                self._values.reject(place, f"{where}: {cause.name} is named more than once")
            causes[cause] = None
            self._block.causes.append(WrittenCause(self._block.name, where, cause, place))
        return tuple(causes)

    def text(self, line: Setting, where: str) -> str:
        """Return a message or a hint."""
        text, place = self._values.text(line, where)
        if len(text) > MAX_TEXT:
            self._values.reject(place, f"{where}: more than {MAX_TEXT} characters", "TOO_LARGE")
        return text

    def severity(self, line: Setting, where: str) -> Severity:
        """Return a severity."""
        return Severity(self._values.choice(line, where, _SEVERITIES))

    def needs_acknowledgement(self, line: Setting, where: str) -> bool:
        """Tell whether the error stays on until it is acknowledged."""
        return self._values.choice(line, where, _RECOVERIES) == "acknowledge"

    def needs_all(self, line: Setting, where: str) -> bool:
        """Tell whether the error follows only once all its causes are on."""
        return self._values.choice(line, where, _NEEDS) == "all"

    def duration(self, line: Setting, where: str) -> int:
        """Return a time, which may be 0."""
        return self._values.duration(line, where, zero=True)

    def some_time(self, line: Setting, where: str) -> int:
        """Return a time that is not 0."""
        return self._values.duration(line, where, zero=False)


_KEYS: Mapping[str, tuple[str, Callable[[_Reader, Setting, str], object]]] = MappingProxyType(
    {
        "when": ("when", _Reader.condition),
        "for_s": ("for_", _Reader.duration),
        "clear_for_s": ("clear_for", _Reader.duration),
        "caused_by": ("caused_by", _Reader.causes),
        "need": ("need_all", _Reader.needs_all),
        "unless": ("unless", _Reader.condition),
        "after_s": ("after", _Reader.duration),
        "expected_within_s": ("expected_within", _Reader.some_time),
        "severity": ("severity", _Reader.severity),
        "recovery": ("needs_acknowledgement", _Reader.needs_acknowledgement),
        "suppressed_when": ("suppressed_when", _Reader.condition),
        "message": ("message", _Reader.text),
        "hint": ("hint", _Reader.text),
    }
)
"""By key: the field that it sets, and what reads its value."""
