"""Values of the settings of a part, each with its type and bounds."""

from collections.abc import Sequence as Values
from typing import NoReturn

from domain.errors import near_match, shortened
from domain.timebase import Duration, seconds
from service.files.extension import Setting
from service.files.parameter_file import scalar_value
from service.files.smh_block import SmhBlock
from service.files.yaml_tree import Node, Scalar, Sequence

LONGEST_S = 86_400.0
"""A day; longest time in the settings of a mode."""


class InvalidSettingError(Exception):
    """A value that cannot be used; a finding says why."""


class SettingValues:
    """Reads values; what is wrong with one becomes a finding of its block."""

    def __init__(self, block: SmhBlock) -> None:
        self._block = block

    def reject(self, place: Node, message: str, code: str = "INVALID_VALUE") -> NoReturn:
        """Report an error.

        Raises:
            InvalidSettingError: Always.
        """
        self._block.complain(place, code, message)
        raise InvalidSettingError

    def texts(self, setting: Setting, where: str, most: int) -> list[tuple[str, Scalar]]:
        """Return the texts of a list, each with its place; one text stands for a list of it.

        Args:
            setting: The line.
            where: The place in words, for messages.
            most: Largest number of items.

        Raises:
            InvalidSettingError: It is not a list of texts.
        """
        value = setting.value
        if value is None:
            return []
        items = value.items if isinstance(value, Sequence) else [value]
        if len(items) > most:
            self.reject(setting.key, f"{where}: more than {most} items", "TOO_LARGE")
        texts = []
        for item in items:
            if isinstance(item, Scalar):
                texts.append((self._text(item, where), item))
            elif item is not None:
                self.reject(item, f"{where}: expected texts, not a list or map")
        return texts

    def text(self, setting: Setting, where: str) -> tuple[str, Scalar]:
        """Return a text with its place.

        Raises:
            InvalidSettingError: It is not a text.
        """
        if not isinstance(setting.value, Scalar):
            self.reject(setting.value or setting.key, f"{where}: expected one text")
        return self._text(setting.value, where), setting.value

    def choice(self, setting: Setting, where: str, choices: Values[str]) -> str:
        """Return one of some words.

        Raises:
            InvalidSettingError: It is none of them.
        """
        text, place = self.text(setting, where)
        if text not in choices:
            near = near_match(text, choices)
            hint = f"; did you mean {near}?" if near else ""
            known = ", ".join(choices)
            self.reject(place, f"{where}: {shortened(text)!r} is none of {known}{hint}")
        return text

    def duration(self, setting: Setting, where: str, *, zero: bool) -> Duration:
        """Return a time that is written in s.

        Args:
            setting: The line.
            where: The place in words, for messages.
            zero: Whether 0 is allowed.

        Raises:
            InvalidSettingError: It is not a number, or out of range.
        """
        place = setting.value or setting.key
        value = scalar_value(place) if isinstance(place, Scalar) else None
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.reject(place, f"{where}: expected a number of seconds")
        if not 0 <= value <= LONGEST_S or (value == 0 and not zero):
            least = "0" if zero else "more than 0"
            self.reject(place, f"{where}: expected {least} to {LONGEST_S:,.0f} s, not {value}")
        return seconds(value)

    def count(self, setting: Setting, where: str, most: int) -> int:
        """Return a whole number from 1.

        Args:
            setting: The line.
            where: The place in words, for messages.
            most: Largest number.

        Raises:
            InvalidSettingError: It is not a whole number, or out of range.
        """
        place = setting.value or setting.key
        value = scalar_value(place) if isinstance(place, Scalar) else None
        if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
            self.reject(place, f"{where}: expected a whole number from 1 to {most:,}")
        return value

    def _text(self, item: Scalar, where: str) -> str:
        value = scalar_value(item)
        if not isinstance(value, str):
            shown = shortened(item.text)
            self.reject(item, f"{where}: expected a text, not {shown!r}; quote it if it is one")
        return value
