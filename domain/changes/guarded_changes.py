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
        """Judge a change, if it has guards, until it is dropped.

        Args:
            change: Of its parts, those whose target mode has guards are judged.
            unguarded: Parts of which the guards do not count.
        """
        change.guarded = frozenset(self._guards.of(change.targets)).difference(unguarded)
        if change.guarded:
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
            parts = sorted(change.guarded)
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
        guarded = [part for part in parts if part in change.guarded]
        broken = next(self._guards.blockers_of_step(guarded, change.targets), None)
        return None if broken is None else broken.message
