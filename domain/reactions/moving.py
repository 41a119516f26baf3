"""What reactions do to their parts: other targets in force, and restarts of nodes."""

from collections.abc import Iterable, Mapping, Sequence, Set

from domain.changes.changing import Changing
from domain.changes.guards import Guards
from domain.health.health import Health
from domain.inputs import Restored
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.reaction_terms import Action, ReactionState
from domain.reactions.displacing import Displacing, Ground
from domain.reactions.reaction import Reaction
from domain.reactions.restarts import Restarts
from domain.reactions.returns import Returns
from domain.snapshot import Because
from domain.state_and_mode import PartName
from domain.timebase import Instant


class Moving:
    """Displaces the targets of parts while reactions act, and lets the parts return."""

    def __init__(
        self,
        reactions: Sequence[Reaction],
        parts: Parts,
        changing: Changing,
        health: Health,
        guards: Guards,
        displacing: Displacing,
        restarts: Restarts,
        outbox: Outbox,
    ) -> None:
        self._reactions = [each for each in reactions if each.declared.action.has_target]
        self._changing = changing
        self._health = health
        self._guards = guards
        self._displacing = displacing
        self._restarts = restarts
        self._outbox = outbox
        self._displacer: dict[PartName, Reaction] = {}
        """By part, the reaction whose target stands, also after it has ended."""
        self._restarting: dict[PartName, Reaction] = {}
        """By node, the reaction that restarts it as long as it acts."""
        self._returns: Returns[Reaction] = Returns(parts, displacing, outbox, self._is_free)

    @property
    def parts(self) -> Set[PartName]:
        """Return the parts whose targets are those of reactions."""
        return self._displacer.keys()

    def restore(self, restored: Restored, acting: Iterable[Reaction], now: Instant) -> None:
        """Displace what an earlier run had displaced; nothing moves because of that.

        Args:
            restored: What was kept.
            acting: The reactions that acted; those that restart a node have done so once.
            now: The current time.
        """
        self._restarting = {
            each.part: each for each in acting if each.declared.action is Action.RESTART
        }
        found = [
            displacer
            for because in (Because.REACTION, Because.LOCAL)
            for displacer in self._displacing.restore(
                restored, because, self._reactions_of(because), now
            )
        ]
        for displacer in found:
            assert isinstance(displacer, Reaction)
            self._displacer[displacer.part] = displacer
            is_over = displacer.state is not ReactionState.ACTING
            self._displacing.let_go(displacer, is_over=is_over)

    def _reactions_of(self, because: Because) -> list[Reaction]:
        return [reaction for reaction in self._reactions if reaction.because is because]

    def follow_stop(self, now: Instant, *, is_stopped: bool) -> None:
        """Note that ESTOP is active, or ends now."""
        if is_stopped:
            self._returns.stop()
        else:
            self._returns.end_stop(now)

    def follow_requests(self) -> bool:
        """Note which displacements a request has ended; return whether one did."""
        ended = [r for r in self._displacer.values() if self._displacing.is_ended(r)]
        for reaction in ended:
            self._displacing.end_by_request(reaction)
            self._returns.forget(reaction)
            del self._displacer[reaction.part]
        return bool(ended)

    def wake_at(self) -> Instant | None:
        """Return when a part may return."""
        return self._returns.wake_at()

    def pass_time(self, now: Instant) -> None:
        """Note which parts may return."""
        self._returns.pass_time(now)

    def go_on(self, now: Instant) -> bool:
        """Let parts return, and nodes come back; return whether anything moved."""
        has_moved = self._restarts.go_on(now)
        has_moved |= self._returns.act(now)
        self._forget_ended()
        return has_moved

    # --- what is decided -------------------------------------------------------------------------

    def move(self, moving: Mapping[PartName, Reaction], now: Instant) -> bool:
        """Put the targets of those reactions in force that move parts, and no others.

        Args:
            moving: By part, the reaction that moves it.
            now: The current time.

        Returns:
            Whether anything changed.
        """
        has_moved = self._restart(moving, now)
        for part, reaction in moving.items():
            if reaction.declared.action is not Action.RESTART:
                has_moved |= self._put(part, reaction, now)
        for part, reaction in list(self._displacer.items()):
            if moving.get(part) is not reaction:
                has_moved |= self._let_go(reaction, now)
        self._returns.pass_time(now)
        return has_moved

    def _restart(self, moving: Mapping[PartName, Reaction], now: Instant) -> bool:
        """Begin the restarts that are new; return whether there are any."""
        before = self._restarting
        self._restarting = {
            part: reaction
            for part, reaction in moving.items()
            if reaction.declared.action is Action.RESTART
        }
        new = [r for part, r in self._restarting.items() if before.get(part) is not r]
        for reaction in new:
            self._restarts.begin(reaction, reaction.event, now)
        return bool(new)

    def _put(self, part: PartName, reaction: Reaction, now: Instant) -> bool:
        """Put the target of a reaction in force, or show why it is; return whether that is new."""
        earlier = self._displacer.get(part)
        if earlier is reaction:
            self._displacing.let_go(reaction, is_over=False)
            self._returns.forget(reaction)
            return self._displacing.explain(reaction, [reaction.cause(reaction.since)])
        if earlier is not None:
            self._returns.forget(earlier)
        way = self._displacing.way_ahead(reaction)
        cause = reaction.cause(reaction.since)
        ground = Ground(reaction.words, (cause,), now, reaction.event)
        self._displacing.displace(reaction, way, ground, now, instead_of=earlier)
        self._displacer[part] = reaction
        if reaction.elsewhere is None:
            self._displacing.set_out(reaction, way, now)
        return True

    def _let_go(self, reaction: Reaction, now: Instant) -> bool:
        """Let a part return as soon as it may; return whether that is new."""
        self._displacing.let_go(reaction, is_over=True)
        if self._returns.stays(reaction):
            return False
        if self._falls_back(reaction):
            # What replaces the target below it is not up to reactions.
            self._returns.forget(reaction)
            self._displacing.take_back(reaction, None, reaction.event, now)
            self._forget_ended()
            return True
        self._returns.note(reaction, now, 0, is_gone=True)
        if self._health.is_stopped:
            self._returns.stop()
        return False

    def _falls_back(self, reaction: Reaction) -> bool:
        """Tell whether the target below that of a reaction is replaced by its fallback."""
        part, target = reaction.part, self._displacing.target_back(reaction)
        if target is None or target.mode is None:
            return False
        has_fallback = self._guards.fallback_of(part, target) is not None
        return has_fallback and not self._guards.can_stay(part, target.mode)

    def _is_free(self, reaction: Reaction) -> bool:
        """Tell whether a part could return now."""
        return self._changing.is_available

    def _forget_ended(self) -> None:
        for part, reaction in list(self._displacer.items()):
            if not self._displacing.acts(reaction):
                del self._displacer[part]
