"""The block `mode_settings` of a part: guards of its modes, what replaces them, and their order."""

from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TypeVar

from domain.conditions.condition import Condition
from domain.errors import near_match, shortened
from domain.findings import Finding
from domain.parts.mode_settings import ModeSettings, OnFailure, TransitionSettings
from domain.parts.settings_check import fallback_circles, order_circles
from domain.parts.system_model import EVERY_MODE
from domain.state_and_mode import ModeName, PartName
from domain.timebase import Duration
from service.files.extension import Setting
from service.files.setting_values import InvalidSettingError, SettingValues
from service.files.smh_block import MODE_SETTINGS, SmhBlock
from service.files.smh_condition import read_condition
from service.files.smh_order import ORDER_KEYS, SEQUENTIAL, Order, OrderReader
from service.files.source_text import SourceText

MAX_CONDITIONS = 50
"""Conditions in one list."""

T = TypeVar("T")

_TRANSITION_KEYS = (*ORDER_KEYS, "deadline_s", "on_failure")
_KEYS = ("requires", "invariants", "grace_s", "fallback", "transition")


@dataclass(slots=True)
class _Written:
    """What the block says about one mode; None: nothing."""

    requires: tuple[Condition, ...] | None = None
    invariants: tuple[Condition, ...] | None = None
    grace: Duration | None = None
    fallback: ModeName | None = None
    deadline: Duration | None = None
    on_failure: OnFailure | None = None
    order: Order = field(default_factory=Order)


def read_mode_settings(
    block: SmhBlock, known: Collection[PartName], source: SourceText
) -> Mapping[ModeName, ModeSettings]:
    """Read the settings of all modes of a part; those of `__ALL__` fill in what a mode lacks.

    Args:
        block: Block of the part; receives findings.
        known: All parts of the model.
        source: Text of the file.
    """
    lines: dict[ModeName, list[Setting]] = {}
    for setting in block.settings:
        if len(setting.path) > 1:
            lines.setdefault(ModeName(setting.path[1]), []).append(setting)
        elif setting.value is not None:
            message = f"{MODE_SETTINGS} of {block.name}: expected modes below it"
            block.complain(setting.key, "NOT_A_BLOCK", message)
    if not lines:
        return {}
    reader = _Reader(block, known, source)
    # A sequence for all modes has an effect in those that say that they are sequential.
    has_order = any(setting.path[2:] == ("transition", "order") for setting in block.settings)
    others = _Written(order=Order(SEQUENTIAL) if has_order else Order())
    every = reader.read(EVERY_MODE, lines.pop(EVERY_MODE, []), others)
    written = {mode: reader.read(mode, of_mode, every) for mode, of_mode in lines.items()}
    return _merged(block, every, written)


def _merged(
    block: SmhBlock, every: _Written, written: Mapping[ModeName, _Written]
) -> dict[ModeName, ModeSettings]:
    """Return complete settings; a mode is not its own fallback because `__ALL__` names it."""
    own = dict(written)
    if every.fallback is not None:
        own.setdefault(every.fallback, _Written())
    parts = block.parts_of_system
    merged = {mode: _settings(mode, of_mode, every, parts) for mode, of_mode in own.items()}
    merged[EVERY_MODE] = _settings(EVERY_MODE, every, every, parts)
    fallbacks = {mode: merged.get(mode, merged[EVERY_MODE]).fallback for mode in block.modes}
    block.findings.extend(fallback_circles(block.name, fallbacks))
    return merged


def _settings(
    mode: ModeName, own: _Written, every: _Written, parts: Collection[PartName]
) -> ModeSettings:
    usual = ModeSettings()
    inherited = None if every.fallback == mode else every.fallback
    return ModeSettings(
        requires=_first(own.requires, every.requires, ()),
        invariants=_first(own.invariants, every.invariants, ()),
        grace=_first(own.grace, every.grace, usual.grace),
        fallback=_first(own.fallback, inherited, None),
        transition=TransitionSettings(
            after=own.order.filled_from(every.order).to_after(parts),
            deadline=_first(own.deadline, every.deadline, None),
            on_failure=_first(own.on_failure, every.on_failure, usual.transition.on_failure),
        ),
    )


def _first(own: T | None, every: T | None, usual: T) -> T:
    """Return the first value that was given."""
    return own if own is not None else every if every is not None else usual


class _Reader:
    """Reads the settings of one part."""

    def __init__(self, block: SmhBlock, known: Collection[PartName], source: SourceText) -> None:
        self._block = block
        self._source = source
        self._known = known
        self._values = SettingValues(block)
        self._unknown: set[tuple[str, ...]] = set()
        """Keys that were reported."""

    def read(self, mode: ModeName, lines: Iterable[Setting], every: _Written) -> _Written:
        """Read the settings of one mode.

        Args:
            mode: The mode, or `__ALL__`.
            lines: Its lines.
            every: The settings of `__ALL__`.
        """
        written = _Written()
        order = OrderReader(self._block, f"{self._block.name} in {mode}", self._known)
        if not self._is_known(mode):
            return written
        for line in lines:
            with suppress(InvalidSettingError):
                self._read_line(mode, line, written, order)
        written.order = order.read_all(every.order)
        if written.order.after:
            circles = order_circles(self._block.name, mode, written.order.after)
            self._block.findings.extend(circles)
        return written

    def _is_known(self, mode: ModeName) -> bool:
        modes, name = self._block.modes, self._block.name
        if mode in modes or (mode == EVERY_MODE and modes):
            return True
        near = near_match(mode, (*modes, EVERY_MODE))
        hint = f"did you mean {near}?" if near else f"it has {shortened(', '.join(modes))}"
        message = f"{name} has no mode {shortened(mode)!r} to set; {hint}"
        if not modes:
            message = f"{name} has no modes, and so {MODE_SETTINGS} has no effect"
        self._complain("UNKNOWN_MODE", message, mode)
        return False

    def _read_line(
        self, mode: ModeName, line: Setting, written: _Written, order: OrderReader
    ) -> None:
        """Read one line.

        Raises:
            InvalidSettingError: It cannot be used.
        """
        key, *below = line.path[2:] or ("",)
        where = f"{self._block.name} in {mode}"
        if len(line.path) == 2:
            if line.value is None:
                return
            self._values.reject(line.key, f"{where}: expected settings below it", "NOT_A_BLOCK")
        if key not in _KEYS:
            self._complain_of_key(_KEYS, mode, key)
        elif key == "transition":
            self._read_transition(mode, tuple(below), line, written, order)
        elif below:
            self._values.reject(line.key, f"{where}, {key}: expected no keys below it")
        elif line.value is not None:
            self._read_setting(mode, key, line, written)

    def _read_setting(self, mode: ModeName, key: str, line: Setting, written: _Written) -> None:
        where = f"{self._block.name} in {mode}, {key}"
        if key == "requires":
            written.requires = self._conditions(line, where)
        elif key == "invariants":
            written.invariants = self._conditions(line, where)
        elif key == "grace_s":
            written.grace = self._values.duration(line, where, zero=True)
        else:
            written.fallback = self._fallback(line, where)

    def _read_transition(
        self,
        mode: ModeName,
        below: tuple[str, ...],
        line: Setting,
        written: _Written,
        order: OrderReader,
    ) -> None:
        where = f"{self._block.name} in {mode}, transition"
        if not below:
            if line.value is not None:
                self._values.reject(line.key, f"{where}: expected keys below it", "NOT_A_BLOCK")
            return
        key, *more = below
        if key not in _TRANSITION_KEYS:
            self._complain_of_key(_TRANSITION_KEYS, mode, "transition", key)
        elif more and key != "after":
            self._values.reject(line.key, f"{where}, {key}: expected no keys below it")
        elif line.value is None:
            return
        elif key in ORDER_KEYS:
            order.read(key, tuple(more), line)
        elif key == "deadline_s":
            written.deadline = self._values.duration(line, f"{where}, {key}", zero=False)
        else:
            choices = [str(choice) for choice in OnFailure]
            word = self._values.choice(line, f"{where}, {key}", choices)
            written.on_failure = OnFailure(word)

    def _conditions(self, line: Setting, where: str) -> tuple[Condition, ...]:
        """Read conditions; one that cannot be read is reported and left out."""
        texts = self._values.texts(line, where, MAX_CONDITIONS)
        read = (read_condition(self._block, self._source, where, *each) for each in texts)
        return tuple(condition for condition in read if condition is not None)

    def _fallback(self, line: Setting, where: str) -> ModeName:
        text, place = self._values.text(line, where)
        modes = self._block.modes
        if text not in modes:
            near = near_match(text, tuple(modes))
            hint = f"did you mean {near}?" if near else f"it has {shortened(', '.join(modes))}"
            message = f"{where}: {self._block.name} has no mode {shortened(text)!r}; {hint}"
            self._values.reject(place, message, "UNKNOWN_MODE")
        return ModeName(text)

    def _complain_of_key(self, known: tuple[str, ...], *keys: str) -> None:
        """Report a key that means nothing, once for all that is below it."""
        if keys in self._unknown:
            return
        self._unknown.add(keys)
        near = near_match(keys[-1], known)
        hint = f"did you mean {near}?" if near else f"known: {', '.join(known)}"
        message = f"{self._block.name} in {keys[0]}: unknown key {shortened(keys[-1])!r}; {hint}"
        self._complain("UNKNOWN_KEY", message, *keys)

    def _complain(self, code: str, message: str, *keys: str) -> None:
        """Report an error at a key of the block."""
        name = self._block.name
        path = (name, MODE_SETTINGS, *keys)
        self._block.findings.append(Finding("error", code, message, name, path))
