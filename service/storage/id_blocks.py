"""Ids that are never used twice: reserved in blocks, on disk, before they are used."""

from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from typing import NewType

from domain.identifiers import ChangeId, TaskId
from domain.kept import KeptChange
from domain.outbox import Outputs

IdKind = NewType("IdKind", str)
EVENT, CHANGE, TASK, BOOT = IdKind("event"), IdKind("change"), IdKind("task"), IdKind("boot")

BLOCKS: Mapping[IdKind, int] = {EVENT: 10_000, CHANGE: 1_000, TASK: 1_000}
"""How many ids are reserved at once; half of them are left when the next block is."""
_BEGINNING = datetime(2020, 1, 1, tzinfo=UTC)
UNKNOWN_TAIL = 100
"""Blocks that are skipped when it is unknown what was reserved last."""


def unreserved(first: Mapping[IdKind, int], wall_at: datetime) -> dict[IdKind, int]:
    """Return ids for a run that cannot reserve any, since nothing can be written.

    No other run uses them, since they are counted from the milliseconds of its start: the next one
    goes on from what was reserved on disk, or starts later.
    """
    base = (wall_at - _BEGINNING) // timedelta(milliseconds=1)
    return {kind: id_ if kind == BOOT else max(id_, base) for kind, id_ in first.items()}


class IdBlocks:
    """The ids of a run.

    Args:
        first: First id of each kind that no earlier run can have used.
    """

    def __init__(self, first: Mapping[IdKind, int]) -> None:
        self._next = {kind: first.get(kind, 1) for kind in BLOCKS}
        self._end = dict(self._next)

    def reserve(self) -> dict[IdKind, int]:
        """Reserve what is needed; return the first id after each block that is new."""
        reserved = {}
        for kind, block in BLOCKS.items():
            if self._end[kind] - self._next[kind] < block // 2:
                reserved[kind] = self._end[kind] = self._next[kind] + block
        return reserved

    def see(self, outputs: Outputs) -> bool:
        """Note the ids that a step used; return whether more should be reserved."""
        is_short = False
        if outputs.events:
            is_short = self._see(EVENT, outputs.events[-1].id)
        if outputs.change is not None:
            is_short |= self._see(CHANGE, _number(outputs.change))
        if outputs.task is not None:
            is_short |= self._see(TASK, _number(outputs.task))
        for item in outputs.kept:
            # Changes that restore a node were not requested.
            if item.kind is KeptChange:
                is_short |= self._see(CHANGE, _number(ChangeId(item.name)))
        return is_short

    def exact(self) -> dict[IdKind, int]:
        """Return the first unused id of each kind, for a run that ends now."""
        return dict(self._next)

    def _see(self, kind: IdKind, used: int) -> bool:
        self._next[kind] = max(self._next[kind], used + 1)
        return self._end[kind] - self._next[kind] < BLOCKS[kind] // 2


def _number(identity: ChangeId | TaskId) -> int:
    """Return the number in an id such as `c12` or `t3`."""
    return int(identity[1:])
