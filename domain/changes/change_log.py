"""The changes that can be asked for: all that run, and the newest of those that ended."""

from domain.changes.record import Change
from domain.errors import UnknownChangeError
from domain.identifiers import ChangeId

KEPT_CHANGES = 1_000
KEPT_PURSUITS = 50_000
"""Pursuits of all changes together; bounds the memory of large changes."""
PACKED_AT_ONCE = 100
"""Nodes of a change that is packed when it ends; a larger one is packed in a turn of its own."""


class ChangeLog:
    """The record of each change by its id, in the order in which they were requested."""

    def __init__(self) -> None:
        self._changes: dict[ChangeId, Change] = {}
        self._to_pack: dict[ChangeId, Change] = {}
        self._count = 0

    def __getitem__(self, identity: ChangeId) -> Change:
        return self._changes[identity]

    def get(self, change: str) -> Change:
        """Return a change.

        Raises:
            UnknownChangeError: The id is unknown, or the change is no longer kept.
        """
        found = self._changes.get(ChangeId(change))
        if found is None:
            hint = f"the last {KEPT_CHANGES} changes are kept; see GET /changes"
            raise UnknownChangeError("change", change, (), hint)
        return found

    def all(self) -> tuple[Change, ...]:
        """Return the changes that are kept, the newest first."""
        return tuple(reversed(self._changes.values()))

    def count_from(self, following: int) -> None:
        """Go on counting: the next change gets this number."""
        self._count = following - 1

    def next_id(self) -> ChangeId:
        """Return a new id."""
        self._count += 1
        return ChangeId(f"c{self._count}")

    def add(self, change: Change) -> None:
        """Add a change, or replace the record of one that waited."""
        self._changes[change.id] = change

    def forget_old(self) -> None:
        """Keep the newest changes, and all that are still running or driving a node."""
        excess = len(self._changes) - KEPT_CHANGES
        kept = sum(change.node_count for change in self._changes.values())
        for identity, change in list(self._changes.items())[:-1]:
            if excess <= 0 and kept <= KEPT_PURSUITS:
                return
            if change.is_over:
                del self._changes[identity]
                excess -= 1
                kept -= change.node_count

    # --- packing ---------------------------------------------------------------------------------

    def pack(self, change: Change) -> None:
        """Pack a change that is over; a large one later."""
        if not change.is_over or change.packed is not None:
            return
        if change.node_count <= PACKED_AT_ONCE:
            change.pack()
        else:
            self._to_pack[change.id] = change

    @property
    def has_more(self) -> bool:
        """Tell whether a large change is to be packed."""
        return bool(self._to_pack)

    def pack_next(self) -> None:
        """Pack a large change, if there is one."""
        if self._to_pack:
            self._to_pack.pop(next(iter(self._to_pack))).pack()
