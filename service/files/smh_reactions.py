"""The block `reactions` of a part: what the robot does while something is so."""

import re
from collections.abc import Collection, Mapping
from contextlib import suppress
from typing import Final, TypeVar

from domain.conditions.condition import Condition
from domain.errors import near_match, shortened
from domain.findings import Finding
from domain.parts.declared_reactions import Budget, DeclaredReaction, Escalation
from domain.reaction_terms import Action, Arm, Until
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Duration
from service.files.extension import Setting
from service.files.setting_values import InvalidSettingError, SettingValues
from service.files.smh_block import REACTIONS, SmhBlock
from service.files.smh_condition import read_condition
from service.files.smh_values import fitted, read_pair
from service.files.source_text import SourceText

WordT = TypeVar("WordT", Action, Arm, Until)

MAX_NAME = 64
"""Characters of a name, which also names a hold."""
MOST_TIMES = 1_000
"""Largest `at_most`."""

_NEVER = Condition("false")
_NAME = re.compile(rf"[A-Za-z0-9][A-Za-z0-9_-]{{0,{MAX_NAME - 1}}}")
_OF_BUDGET: Final = ("at_most", "in_s", "on_exhausted")
_OF_ESCALATION: Final = ("escalate_after_s", "escalate_to")
_KEYS: Final = (
    "when",
    "for_s",
    "action",
    "target",
    "until",
    "arm",
    *_OF_BUDGET,
    *_OF_ESCALATION,
)


def read_reactions(
    block: SmhBlock, with_modes: Collection[PartName], source: SourceText
) -> dict[str, DeclaredReaction]:
    """Read the reactions of a part; one with errors is included as far as it can be read.

    Args:
        block: Block of the part; receives findings.
        with_modes: All parts that have modes.
        source: Text of the file.
    """
    lines: dict[str, list[Setting]] = {}
    for setting in block.reactions:
        if len(setting.path) > 1:
            lines.setdefault(setting.path[1], []).append(setting)
        elif setting.value is not None:
            message = f"{REACTIONS} of {block.name}: expected names below it"
            block.complain(setting.key, "NOT_A_BLOCK", message)
    return {name: _Reader(block, name, with_modes, source).read(lines[name]) for name in lines}


class _Reader:
    """Reads one reaction."""

    def __init__(
        self, block: SmhBlock, name: str, with_modes: Collection[PartName], source: SourceText
    ) -> None:
        self._block = block
        self._name = name
        self._with_modes = with_modes
        self._source = source
        self._values = SettingValues(block)
        self._where = f"reaction {name} of {block.name}"

    def read(self, lines: list[Setting]) -> DeclaredReaction:
        """Return the reaction that some lines declare."""
        if not _NAME.fullmatch(self._name):
            message = (
                f"{self._where}: a name has letters, digits, _ and - only, begins with a letter "
                f"or a digit, and has at most {MAX_NAME} characters"
            )
            self._complain("INVALID_NAME", message)
        by_key: dict[str, Setting] = {}
        for line in lines:
            with suppress(InvalidSettingError):
                if (key := self._key_of(line)) is not None:
                    by_key[key] = line
        return self._reaction(by_key)

    def _key_of(self, line: Setting) -> str | None:
        """Return the key of a line with a value; None: it says nothing that can be used.

        Raises:
            InvalidSettingError: It is not a line of a reaction.
        """
        if len(line.path) == 2:
            if line.value is not None:
                message = f"{self._where}: expected keys below it"
                self._values.reject(line.key, message, "NOT_A_BLOCK")
            return None
        key = line.path[2]
        if key not in _KEYS:
            near = near_match(key, _KEYS)
            hint = f"did you mean {near}?" if near else f"known: {', '.join(_KEYS)}"
            self._complain(
                "UNKNOWN_KEY", f"{self._where}: unknown key {shortened(key)!r}; {hint}", key
            )
        elif len(line.path) > 3:
            self._values.reject(line.key, f"{self._where}, {key}: expected no keys below it")
        elif line.value is not None:
            return key
        return None

    def _reaction(self, lines: Mapping[str, Setting]) -> DeclaredReaction:
        missing = [key for key in ("when", "action") if key not in lines]
        if missing:
            message = f"{self._where} lacks {' and '.join(missing)}"
            self._complain("INCOMPLETE_REACTION", message)
        action = self._word(lines.get("action"), Action.TELL)
        target = None
        if "target" in lines and (target := self._target(lines["target"])) is None:
            action = Action.TELL  # Nothing more is said about its target.
        at_most, within, exhausted = self._budget(lines, action)
        return DeclaredReaction(
            self._name,
            self._block.name,
            self._condition(lines.get("when")) or _NEVER,
            action,
            self._duration(lines.get("for_s"), usual=0, zero=True),
            target,
            self._word(lines.get("until"), Until.CLEARED),
            self._word(lines.get("arm"), Arm.ACTIVE),
            Budget(at_most, within),
            exhausted,
            self._escalation(lines),
        )

    # --- one key each ----------------------------------------------------------------------------

    def _condition(self, line: Setting | None) -> Condition | None:
        if line is not None:
            with suppress(InvalidSettingError):
                where = f"{self._where}, when"
                text, place = self._values.text(line, where)
                return read_condition(self._block, self._source, where, text, place)
        return None

    def _target(self, line: Setting) -> StateAndMode | None:
        with suppress(InvalidSettingError):
            text, place = self._values.text(line, f"{self._where}, target")
            pair = read_pair(self._block, f"{self._where}, target", text, place)
            return None if pair is None else fitted(pair, self._block.name, self._with_modes)
        return None

    def _budget(self, lines: Mapping[str, Setting], action: Action) -> tuple[int, Duration, Action]:
        """Read how often it may act within which time, and what it does then."""
        usual = Budget()
        given = [key for key in _OF_BUDGET if key in lines]
        if given and "action" in lines and not action.has_budget:
            message = f"{self._where}: {action} may act at any time; leave out {', '.join(given)}"
            self._complain("INVALID_REACTION", message, given[0])
        at_most = usual.at_most
        if "at_most" in lines:
            with suppress(InvalidSettingError):
                where = f"{self._where}, at_most"
                at_most = self._values.count(lines["at_most"], where, MOST_TIMES)
        within = self._duration(lines.get("in_s"), usual=usual.within, zero=False)
        exhausted = self._word(lines.get("on_exhausted"), Action.HOLD)
        if exhausted.has_budget:
            message = f"{self._where}: on_exhausted is tell, hold, stop or emergency_stop"
            self._complain("INVALID_REACTION", message, "on_exhausted")
        return at_most, within, exhausted

    def _escalation(self, lines: Mapping[str, Setting]) -> Escalation | None:
        given = [key for key in _OF_ESCALATION if key in lines]
        if len(given) < len(_OF_ESCALATION):
            if given:
                message = f"{self._where}: write {' and '.join(_OF_ESCALATION)}, or neither"
                self._complain("INCOMPLETE_REACTION", message, given[0])
            return None
        after = self._duration(lines["escalate_after_s"], usual=0, zero=True)
        with suppress(InvalidSettingError):
            to, _ = self._values.text(lines["escalate_to"], f"{self._where}, escalate_to")
            return Escalation(after, to)
        return None

    def _duration(self, line: Setting | None, *, usual: Duration, zero: bool) -> Duration:
        if line is not None:
            with suppress(InvalidSettingError):
                return self._values.duration(line, f"{self._where}, {line.path[2]}", zero=zero)
        return usual

    def _word(self, line: Setting | None, usual: WordT) -> WordT:
        """Read one of the words of an enumeration."""
        if line is not None:
            kind = type(usual)
            with suppress(InvalidSettingError):
                where = f"{self._where}, {line.path[2]}"
                return kind(self._values.choice(line, where, [str(word) for word in kind]))
        return usual

    def _complain(self, code: str, message: str, *keys: str) -> None:
        """Report an error at a key of the reaction."""
        name = self._block.name
        path = (name, REACTIONS, self._name, *keys)
        self._block.findings.append(Finding("error", code, message, name, path))
