"""The requested targets that survive a restart.

A request is kept as it was made, so that a mode of a system of ten thousand nodes is one value. It
is forgotten once later requests have replaced the targets of all its parts.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Protocol

from domain.changes.plan import targets_of
from domain.events.service import NotRestored
from domain.kept import Kept, KeptTarget
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName, StateAndMode


class RequestOrder(Protocol):
    """Which request set the target of each part, in numbers that rise with each request."""

    @property
    def newest(self) -> int:
        """Return the number of the last request."""
        ...

    def of(self, part: PartName) -> int:
        """Return the number of the request that set the target of a part; 0: none did."""
        ...


class KeptTargets:
    """Which request set the target of each part last."""

    def __init__(self, model: SmhModel, outbox: Outbox) -> None:
        self._model = model
        self._outbox = outbox
        self._order = 0
        """Of the last request."""
        self._owner: dict[PartName, int] = {}
        """By part with a target, the order of the request that set it."""
        self._count: dict[int, int] = {}
        """By order of a request, how many parts have their targets from it."""

    @property
    def newest(self) -> int:
        """Return the order of the last request."""
        return self._order

    def of(self, part: PartName) -> int:
        """Return the order of the request that set the target of a part; 0: none did."""
        return self._owner.get(part, 0)

    def note(self, part: PartName, targets: Mapping[PartName, StateAndMode]) -> None:
        """Keep a request.

        Args:
            part: The requested part.
            targets: All targets that it set, also that of `part`.
        """
        self._order += 1
        target = targets[part]
        self._outbox.keep(KeptTarget(part, target, self._order, staying_in(target, targets)))
        self._own(self._order, targets)

    def restore_before(self, targets: Mapping[PartName, StateAndMode | None]) -> None:
        """Keep targets again that a request had replaced; None: there was none."""
        for part, target in targets.items():
            if target is None:
                self._disown([part])
                self._owner.pop(part, None)
            else:
                self._order += 1
                self._outbox.keep(KeptTarget(part, target, self._order))
                self._own(self._order, [part])

    def restore(self, kept: Iterable[Kept]) -> Iterator[dict[PartName, StateAndMode]]:
        """Yield the targets that follow from each request that was kept, in their order.

        Requests that the model no longer allows are left out, and told.
        """
        requests = [value for value in kept if isinstance(value, KeptTarget)]
        for request in sorted(requests, key=lambda value: value.order):
            self._order = request.order
            if (refusal := self._refusal(request)) is not None:
                what = f"the target {request.target.label} of {request.part}"
                self._outbox.emit(NotRestored(what, refusal))
                self._outbox.forget(KeptTarget, request.name)
                continue
            found = self._targets_of(request)
            self._own(request.order, found)
            yield found

    def _targets_of(self, request: KeptTarget) -> dict[PartName, StateAndMode]:
        targets = targets_of(self._model, request.part, request.target)
        for node, state in request.staying.items():
            if node in targets:
                targets[node] = StateAndMode(state)
        return targets

    def _refusal(self, request: KeptTarget) -> str | None:
        """Return why the model does not allow a request any more; None: it does."""
        part, mode = request.part, request.target.mode
        if part not in self._model:
            return f"the model has no part {part!r}"
        if mode is not None and mode not in self._model.modes_of(part):
            return f"{part} has no mode {mode!r}"
        return None

    def _own(self, order: int, parts: Collection[PartName]) -> None:
        """Note that a request set the targets of parts; forget those that have none left."""
        self._disown(parts)
        self._owner.update(dict.fromkeys(parts, order))
        self._count[order] = len(parts)

    def _disown(self, parts: Collection[PartName]) -> None:
        """Note that the targets of parts are replaced; forget requests that have none left."""
        replaced = Counter(map(self._owner.get, parts))
        for earlier, count in replaced.items():
            if earlier is None:
                continue
            self._count[earlier] -= count
            if not self._count[earlier]:
                del self._count[earlier]
                self._outbox.forget(KeptTarget, str(earlier))


def staying_in(
    target: StateAndMode, targets: Mapping[PartName, StateAndMode]
) -> dict[PartName, LifecycleState]:
    """Return the parts that a request towards rest leaves in the state that they are in."""
    if target.state is LifecycleState.ACTIVE:
        return {}
    return {part: own.state for part, own in targets.items() if own.state is not target.state}
