"""The displacements that survive a restart."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from domain.changes.kept_targets import RequestOrder, staying_in
from domain.changes.plan import targets_of
from domain.events.service import NotRestored
from domain.kept import Kept, KeptEffectiveTarget
from domain.outbox import Outbox
from domain.parts.system_model import SmhModel
from domain.parts.targets import OF_REACTIONS, Displacement
from domain.reactions.displacer import Displacer, key_of
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant


class KeptDisplacements:
    """What is kept of each displacement; all kinds share one order."""

    def __init__(self, model: SmhModel, requests: RequestOrder, outbox: Outbox) -> None:
        self._model = model
        self._requests = requests
        self._outbox = outbox
        self._order = 0
        """Of the last displacement."""
        self._kept: dict[Displacement, KeptEffectiveTarget] = {}

    def since(self, displaced: Displacement) -> Instant:
        """Return when a displacement began."""
        return self._kept[displaced].since

    def begin(self, displaced: Displacement, now: Instant) -> None:
        """Keep a new displacement."""
        self._order += 1
        target = displaced.target
        self._keep(
            displaced,
            KeptEffectiveTarget(
                displaced.system,
                target,
                displaced.name,
                self._order,
                self._requests.newest,
                displaced.cause,
                now,
                staying_in(target, displaced.targets),
                str(displaced.because),
            ),
        )

    def renew(self, displaced: Displacement) -> None:
        """Keep anew which nodes a displacement leaves as they are, if that changed."""
        kept = self._kept[displaced]
        staying = staying_in(displaced.target, displaced.targets)
        if staying != kept.staying:
            self._keep(displaced, replace(kept, staying=staying))

    def forget(self, displaced: Displacement) -> None:
        """Keep a displacement no longer."""
        kept = self._kept.pop(displaced)
        self._outbox.forget(KeptEffectiveTarget, kept.name)

    def restore(
        self,
        kept: Iterable[Kept],
        because: Because,
        displacers: Iterable[Displacer],
        now: Instant,
    ) -> Iterator[tuple[Displacement, Displacer]]:
        """Yield the displacements of one kind that were kept, in their order.

        Those that the model no longer has are left out, and told.

        Args:
            kept: What an earlier run left.
            because: The kind.
            displacers: All of that kind that the model has.
            now: The current time; nothing began later.
        """
        known = {key_of(displacer): displacer for displacer in displacers}
        values = [each for each in kept if isinstance(each, KeptEffectiveTarget)]
        for value in sorted(values, key=lambda value: value.order):
            if value.because != because:
                continue
            self._order = max(self._order, value.order)
            displacer = known.get((because, value.part, value.rule, value.target))
            if displacer is None:
                self._leave_out(value)
                continue
            found = Displacement(
                value.part,
                self._targets_of(value),
                because,
                value.rule,
                value.cause,
                strength=displacer.strength,
            )
            self._kept[found] = replace(value, since=min(value.since, now))
            yield found, displacer

    def _leave_out(self, value: KeptEffectiveTarget) -> None:
        label, part = value.target.label, value.part
        what = f"the target {label} of {part} that a rule set"
        reason = f"the model has no rule {value.rule!r} that sets it"
        if value.because in OF_REACTIONS:
            what = f"the target {label} of {part} that a reaction set"
            reason = f"the model has no reaction {value.rule!r} that sets it"
        if value.because == Because.INVARIANT:
            what = f"the target {label} of {part}, a fallback"
            reason = "no mode of the model falls back to it"
        self._outbox.emit(NotRestored(what, reason))
        self._outbox.forget(KeptEffectiveTarget, value.name)

    def _targets_of(self, kept: KeptEffectiveTarget) -> dict[PartName, StateAndMode]:
        targets = {
            part: StateAndMode(kept.staying[part]) if part in kept.staying else target
            for part, target in targets_of(self._model, kept.part, kept.target).items()
            # No request takes a part out of what a reaction has set.
            if kept.because in OF_REACTIONS or self._requests.of(part) <= kept.after
        }
        return {kept.part: kept.target, **targets}

    def _keep(self, displaced: Displacement, value: KeptEffectiveTarget) -> None:
        self._kept[displaced] = value
        self._outbox.keep(value)
