"""The displacements of rules that survive a restart."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from domain.changes.kept_targets import RequestOrder, staying_in
from domain.changes.plan import targets_of
from domain.events.service import NotRestored
from domain.kept import Kept, KeptEffectiveTarget
from domain.outbox import Outbox
from domain.parts.system_model import SmhModel
from domain.parts.targets import Displacement
from domain.reactions.rule_watch import RuleWatch
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant


class KeptRules:
    """What is kept of each displacement."""

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
                displaced.rule,
                self._order,
                self._requests.newest,
                displaced.cause,
                now,
                staying_in(target, displaced.targets),
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
        self, kept: Iterable[Kept], rules: Mapping[tuple[PartName, str], RuleWatch], now: Instant
    ) -> Iterator[tuple[Displacement, RuleWatch]]:
        """Yield the displacements that were kept, with their rules, in their order.

        Those whose rule the model no longer has are left out, and told.
        """
        displaced = [value for value in kept if isinstance(value, KeptEffectiveTarget)]
        for value in sorted(displaced, key=lambda value: value.order):
            self._order = value.order
            watch = rules.get((value.part, value.rule))
            if watch is None or watch.rule.new_target != value.target:
                what = f"the target {value.target.label} of {value.part} that a rule set"
                reason = f"the model has no rule {value.rule!r} that sets it"
                self._outbox.emit(NotRestored(what, reason))
                self._outbox.forget(KeptEffectiveTarget, value.name)
                continue
            found = Displacement(
                value.part, self._targets_of(value), Because.RULE, value.rule, value.cause
            )
            self._kept[found] = replace(value, since=min(value.since, now))
            yield found, watch

    def _targets_of(self, kept: KeptEffectiveTarget) -> dict[PartName, StateAndMode]:
        targets = {
            part: StateAndMode(kept.staying[part]) if part in kept.staying else target
            for part, target in targets_of(self._model, kept.part, kept.target).items()
            if self._requests.of(part) <= kept.after
        }
        return {kept.part: kept.target, **targets}

    def _keep(self, displaced: Displacement, value: KeptEffectiveTarget) -> None:
        self._kept[displaced] = value
        self._outbox.keep(value)
