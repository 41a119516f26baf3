"""The running changes whose modes have guards, judged whenever a guard ceases to hold."""

from collections.abc import Collection

from domain.changes.guards import Guards
from domain.changes.record import Change
from domain.identifiers import ChangeId
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName
from domain.timebase import Instant


class GuardedChanges:
    """Tells which changes must not go on."""

    def __init__(self, guards: Guards, model: SmhModel) -> None:
        """Begin without changes.

        Args:
            guards: Of all modes.
            model: Says which systems a node belongs to.
        """
        self._guards = guards
        self._model = model
        self._running: dict[ChangeId, Change] = {}
        self._revision: int | None = None
        """That of the guards when the changes were judged last; None: they have to be."""
        self._due: Instant | None = None

    @property
    def due(self) -> Instant | None:
        """Return when the grace of a broken invariant ends; None: none is broken."""
        return self._due

    def add(self, change: Change, unguarded: Collection[PartName] = ()) -> None:
        """Judge a change, if it may have guards, until it is dropped.

        Args:
            change: Its parts are judged by the guards of their target modes.
            unguarded: Parts of which the guards do not count.
        """
        if change.targets and not self._guards.are_none:
            change.unguarded = frozenset(unguarded)
            self._running[change.id], self._revision = change, None

    def drop(self, change: Change) -> None:
        """Judge a change no more."""
        if self._running.pop(change.id, None) is not None and not self._running:
            self._due = None

    def broken(self, now: Instant) -> list[tuple[Change, str]]:
        """Return the changes of which an invariant is broken for longer than its grace, and why."""
        is_due = self._due is not None and self._due <= now
        if not self._running or (self._revision == self._guards.revision and not is_due):
            return []
        self._revision = self._guards.revision
        found: list[tuple[Change, str]] = []
        dues: list[Instant] = []
        for change in self._running.values():
            assert change.unguarded is not None
            parts = sorted(set(self._guards.failing(change.targets.keys())) - change.unguarded)
            blocker, due = self._guards.broken_for_too_long(parts, change.targets, now)
            if blocker is not None:
                found.append((change, blocker.message))
            if due is not None:
                dues.append(due)
        self._due = min(dues, default=None)
        return found

    def forbids(self, change: Change, node: PartName) -> str | None:
        """Return which guard keeps a node from its next step; None: none does."""
        parts = (*reversed(self._model.ancestors[node]), node)
        left_out = change.unguarded or frozenset()
        guarded = [part for part in parts if part in change.targets and part not in left_out]
        broken = next(self._guards.blockers_of_step(guarded, change.targets), None)
        return None if broken is None else broken.message
