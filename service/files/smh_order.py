"""The order in which the parts of a system enter a mode, as a file says it."""

from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import islice, pairwise

from domain.errors import near_match, shortened
from domain.state_and_mode import PartName
from service.files.extension import Setting
from service.files.setting_values import InvalidSettingError, SettingValues
from service.files.smh_block import SmhBlock
from service.files.smh_values import read_part_name
from service.files.yaml_tree import Scalar

SEQUENTIAL = "sequential"
ORDER_KEYS = ("order", "sequence", "after")
_ORDERS = ("simultaneous", SEQUENTIAL)
_MAX_PARTS = 10_000
"""Parts in one list."""

_MOST_COMPARED = 200
"""Names that one may be a slip of."""


@dataclass(frozen=True, slots=True)
class Order:
    """What a mode says about the order; None: nothing."""

    order: str | None = None
    sequence: tuple[PartName, ...] | None = None
    after: Mapping[PartName, tuple[PartName, ...]] | None = None

    def filled_from(self, every: "Order") -> "Order":
        """Fill in what this one does not say; what would contradict it is left out."""
        if self.after is not None:
            return self
        if self.order is None and self.sequence is None and every.after is not None:
            return every
        order = self.order or every.order
        sequence = self.sequence or every.sequence
        return Order(order, sequence if order == SEQUENTIAL else self.sequence)

    def to_after(self, parts: Collection[PartName]) -> Mapping[PartName, tuple[PartName, ...]]:
        """Return the parts that must be done before each part.

        Args:
            parts: All parts of the system, in the order of the file.
        """
        if self.after is not None:
            return self.after
        if self.order != SEQUENTIAL:
            return {}
        return {second: (first,) for first, second in pairwise(self.sequence or parts)}


class OrderReader:
    """Reads the lines about the order of one mode."""

    def __init__(self, block: SmhBlock, where: str, known: Collection[PartName]) -> None:
        """Prepare to read.

        Args:
            block: Block of the part; receives findings.
            where: The mode in words, for messages.
            known: All parts of the model.
        """
        self._block = block
        self._where = where
        self._known = known
        self._values = SettingValues(block)
        self._keys: dict[str, Scalar] = {}
        self._order: str | None = None
        self._sequence: tuple[PartName, ...] | None = None
        self._after: dict[PartName, tuple[PartName, ...]] = {}

    def read(self, key: str, below: tuple[str, ...], setting: Setting) -> None:
        """Read one line.

        Args:
            key: One of `ORDER_KEYS`.
            below: Words of the name below that key.
            setting: The line.

        Raises:
            InvalidSettingError: It cannot be used.
        """
        where = f"{self._where}, {key}"
        if self._block.is_node:
            message = f"{where}: a node has no parts; the order is a setting of systems"
            self._values.reject(setting.key, message, "ORDER_OF_A_NODE")
        self._keys.setdefault(key, setting.key)
        if key == "after":
            self._read_after(where, below, setting)
        elif key == "order":
            self._order = self._values.choice(setting, where, _ORDERS)
        else:
            sequence = self._parts(setting, where)
            twice = next((part for part, times in Counter(sequence).items() if times > 1), None)
            if twice is not None:
                message = f"{where}: {twice} is named more than once"
                self._values.reject(setting.value or setting.key, message)
            self._sequence = sequence

    def read_all(self, every: Order) -> Order:
        """Return what the lines say together, after reporting what contradicts itself.

        Args:
            every: What is said for all modes.
        """
        after = self._after if "after" in self._keys else None
        own = Order(self._order, self._sequence, after)
        if after is not None:
            for key in ("order", "sequence"):
                if key in self._keys:
                    message = f"{self._where}: write either after or {key}, not both"
                    self._block.complain(self._keys[key], "ORDER_CONFLICT", message)
        elif self._sequence is not None and (self._order or every.order) != SEQUENTIAL:
            message = f"{self._where}: sequence has no effect without order: {SEQUENTIAL}"
            self._block.complain(self._keys["sequence"], "ORDER_CONFLICT", message)
        elif self._sequence is not None:
            self._compare_parts(self._sequence)
        return own

    def _compare_parts(self, sequence: Collection[PartName]) -> None:
        named = set(sequence)
        missing = [part for part in self._block.parts_of_system if part not in named]
        if missing:
            message = (
                f"{self._where}: sequence lacks {shortened(', '.join(missing))}; a part that is "
                "not in it begins at once"
            )
            self._block.warn(self._keys["sequence"], "SEQUENCE_INCOMPLETE", message)

    def _read_after(self, where: str, below: tuple[str, ...], setting: Setting) -> None:
        if len(below) != 1:
            message = f"{where}: expected parts, each with the parts that must be done before it"
            self._values.reject(setting.key, message, "NOT_A_BLOCK")
        part = self._part(below[0], setting.key, where)
        before = self._parts(setting, f"{where}, {below[0]}")
        if part is not None:
            self._after[part] = before

    def _parts(self, setting: Setting, where: str) -> tuple[PartName, ...]:
        """Return a list of parts, after reporting each name that is none.

        Raises:
            InvalidSettingError: One is none.
        """
        texts = self._values.texts(setting, where, _MAX_PARTS)
        parts = [self._part(text, place, where) for text, place in texts]
        if None in parts:
            raise InvalidSettingError
        return tuple(part for part in parts if part is not None)

    def _part(self, text: str, place: Scalar, where: str) -> PartName | None:
        """Return a name as that of a part of the system; None after reporting that it is none."""
        part = read_part_name(self._block, where, text, place)
        parts = self._block.parts_of_system
        if part in parts:
            return part
        near = near_match(part, tuple(islice(parts, _MOST_COMPARED)))
        hint = f"; did you mean {near}?" if near else ""
        what = "is not a part of" if part in self._known else "is no part, and none of"
        message = f"{where}: {shortened(part)} {what} {self._block.name}{hint}"
        self._block.complain(place, "UNKNOWN_PART", message)
        return None
