"""Invariants of modes in force: what replaces a mode while one of them is broken.

While no change of a part runs, an invariant of its mode that is broken for longer than its grace
puts the fallback of that mode in force; without a fallback, only the error INVARIANT_BROKEN says
so. The part returns once all guards of what was replaced have held for a time: as rules let it.
"""

from collections.abc import Iterable

from domain.changes.changing import Changing
from domain.changes.guards import INVARIANT, Guards
from domain.concern import Concern, Takers
from domain.deadlines import Deadlines
from domain.findings import Blocker
from domain.health.health import Health
from domain.health.part_errors import PartErrors
from domain.identifiers import ChangeId
from domain.inputs import BackendStatus, Restored
from domain.outbox import Outbox
from domain.parts.convergence import bottom_up
from domain.parts.parts import Parts
from domain.reactions.bounds import Bounds
from domain.reactions.displacing import Displacing, Ground
from domain.reactions.fallback import Fallback
from domain.reactions.returns import Returns
from domain.reactions.settings import HEARD_WITHIN, MAX_RETURNS, MIN_RELIEF
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant, to_seconds


class Fallbacks(Concern):
    """Watches the invariants of all modes in force, and decides what follows when one is broken."""

    def __init__(
        self,
        parts: Parts,
        changing: Changing,
        health: Health,
        part_errors: PartErrors,
        guards: Guards,
        displacing: Displacing,
        outbox: Outbox,
    ) -> None:
        """Begin without a fallback in force.

        Args:
            parts: Targets in force of all parts.
            changing: Tells whether a change could begin.
            health: Tells whether ESTOP is active.
            part_errors: Raises INVARIANT_BROKEN.
            guards: Of all modes.
            displacing: Puts targets in force.
            outbox: Receives events.
        """
        self._parts = parts
        self._changing = changing
        self._health = health
        self._errors = part_errors
        self._guards = guards
        self._displacing = displacing
        self._outbox = outbox
        self._rank = {part: number for number, part in enumerate(_with_invariants(parts))}
        """The parts that have invariants; outer systems come first, and take those below along."""
        self._fallbacks = {
            (fallback.system, fallback.mode): fallback for fallback in _fallbacks_of(parts)
        }
        self._acting: dict[PartName, Fallback] = {}
        """The fallback that replaces the mode of a part, or did until the current input."""
        self._changes: dict[PartName, ChangeId] = {}
        """The change that led a part to its fallback."""
        bounds = Bounds("invariant_return", self._rank, MAX_RETURNS, outbox)
        self._returns = Returns(parts, displacing, outbox, self._is_free, bounds)
        self._broken: dict[PartName, int] = {}
        """Parts with a broken invariant, and the event with which it broke."""
        self._deadlines: Deadlines[PartName] = Deadlines()
        """When a broken invariant has outlasted its grace."""
        self._due: set[PartName] = set()
        self._revision: int | None = None
        """That of the guards when they were judged last; None: all parts have to be judged."""
        self._unknown_from: Instant = 0
        """From when on an unknown invariant counts: a restarted service has to hear first."""
        self._was_stopped = False
        self._stop_ended_at: Instant | None = None

    # --- what happens ----------------------------------------------------------------------------

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input."""
        return {Restored: self.restore, BackendStatus: self._follow_backend}

    def restore(self, restored: Restored, now: Instant) -> None:
        """Displace what an earlier run had displaced."""
        fallbacks = self._fallbacks.values()
        acting = self._displacing.restore(restored, Because.INVARIANT, fallbacks, now)
        self._acting = {fallback.system: self._of(fallback) for fallback in acting}
        self._returns.restore(restored.kept, now)
        self._revision = None
        if restored.is_restart:
            self._unknown_from = now + HEARD_WITHIN

    def _follow_backend(self, status: BackendStatus, now: Instant) -> None:
        self._revision = None

    def wake_at(self) -> Instant | None:
        """Return when the next grace ends, or the next part may return."""
        times = (self._deadlines.next(), self._returns.wake_at())
        return min((at for at in times if at is not None), default=None)

    def pass_time(self, now: Instant) -> None:
        """Note which invariants are broken for too long, and which parts may return."""
        while (part := self._deadlines.pop_due(now)) is not None:
            self._due.add(part)
        self._returns.pass_time(now)

    def settle(self, now: Instant) -> bool:
        """Put fallbacks in force, or let one part return; return whether anything changed."""
        if not self._rank:
            return False
        if self._parts.awaits_devices:
            # Once all computers were heard, or could have been, all is judged anew.
            self._revision = None
            return False
        parts = self._to_review()
        has_moved = self._follow_requests(parts)
        broken = []
        for part in parts:
            if self._look(part, now) is None:
                has_moved |= self._errors.note_invariant(part, None, None, now)
            else:
                broken.append(part)
            has_moved |= self._note_return(part, now)
        self._follow_stop(now)
        for part in broken:
            has_moved |= self._follow_broken(part, now)
        return self._returns.act(now) or has_moved

    def _to_review(self) -> list[PartName]:
        """Return the parts of which something changed that may matter; outer systems first.

        That are those with a guard that does not hold, or did not. Of a large robot, only few are:
        a request, or a guard that many parts have, must not look at all others.
        """
        review, self._due = self._due, set()
        moved, known = self._guards.take_moved(), self._acting.keys() | self._broken.keys()
        seen, self._revision = self._revision, self._guards.revision
        if seen is None:
            return list(self._rank)
        if seen != self._revision:
            review |= known
        for touched in (moved, self._outbox.parts):
            review |= touched & known
            review.update(self._rank.keys() & self._guards.failing(touched))
        return sorted(review, key=self._rank.__getitem__)

    def _follow_requests(self, parts: Iterable[PartName]) -> bool:
        """Note which displacements have ended; return whether a request ended one."""
        ended = False
        for part in parts:
            fallback = self._acting.get(part)
            if fallback is None:
                continue
            if self._displacing.acts(fallback):
                if not self._displacing.is_ended(fallback):
                    continue
                self._displacing.end_by_request(fallback)
                ended = True
            self._returns.forget(fallback)
            del self._acting[part]
            self._changes.pop(part, None)
        return ended

    def _follow_stop(self, now: Instant) -> None:
        """Let what ESTOP prevents, or what its end makes true, lead to no return."""
        is_stopped = self._health.is_stopped
        if is_stopped:
            self._returns.stop()
        elif self._was_stopped:
            self._stop_ended_at = now
        if self._stop_ended_at == now:
            self._returns.end_stop(now)
        self._was_stopped = is_stopped

    # --- what holds ------------------------------------------------------------------------------

    def _look(self, part: PartName, now: Instant) -> Blocker | None:
        """Return which invariant of the mode in force is broken for too long; None: none is."""
        target = self._parts.target(part)
        blocker = due = None
        if target is not None:
            blocker, due = self._judge(part, target, now)
        if due is None:
            self._deadlines.clear(part)
        else:
            self._deadlines.set(part, due)
        if blocker is None and due is None:
            self._broken.pop(part, None)
        elif part not in self._broken:
            self._broken[part] = self._outbox.record_input()
        return blocker

    def _judge(
        self, part: PartName, target: StateAndMode, now: Instant
    ) -> tuple[Blocker | None, Instant | None]:
        targets = {part: target}
        return self._guards.broken_for_too_long((part,), targets, now, self._unknown_from)

    def _note_return(self, part: PartName, now: Instant) -> bool:
        """Note whether a part may return; return whether why it may not is shown anew."""
        fallback = self._acting.get(part)
        if fallback is None:
            return False
        self._displacing.keep(fallback)
        target = self._displacing.target_back(fallback)
        broken = () if target is None else self._guards.broken(part, target)
        grace = 0 if target is None else self._guards.grace_of(part, target)
        lasts = max(grace, MIN_RELIEF)
        is_gone = not broken and self._displacing.prevails(fallback)
        self._returns.note(fallback, now, lasts, is_gone=is_gone)
        if self._returns.stays(fallback):
            return False
        if not broken:
            why = f"{part} returns when its guards have held for {to_seconds(lasts):g} s"
            broken = (Blocker(INVARIANT, why, (part,), refuses=False),)
        return self._displacing.explain(fallback, broken)

    def _is_free(self, fallback: Fallback) -> bool:
        """Tell whether a part could move, and nothing moves it but its fallback."""
        return self._is_at_rest(fallback.system) and self._changing.is_available

    def _is_at_rest(self, part: PartName) -> bool:
        """Tell whether no change of a part runs but that of its fallback."""
        running = self._parts.change_of(part)
        return running is None or running == self._changes.get(part)

    # --- what follows ----------------------------------------------------------------------------

    def _follow_broken(self, part: PartName, now: Instant) -> bool:
        """Put the fallback of a mode in force, or raise its error; return whether that is new."""
        target, blocker = self._parts.target(part), self._look(part, now)
        if target is None or blocker is None or not self._is_at_rest(part):
            # The fallback of a system took the part along, or the change that runs will fail.
            return False
        fallback = self._fallback_of(part, target, now)
        if fallback is not None and self._is_free(fallback):
            self._fall_back(fallback, blocker, now)
            return True
        return self._errors.note_invariant(part, blocker, self._broken[part], now)

    def _fallback_of(self, part: PartName, target: StateAndMode, now: Instant) -> Fallback | None:
        """Return what replaces a target; None: nothing does.

        Nothing replaces what a reaction has set. A fallback whose own invariants are broken is left
        out for its own fallback, if it has one.
        """
        if part in self._parts.beyond(Because.INVARIANT):
            return None
        found, passed = None, {target.mode}
        mode = self._guards.fallback_of(part, target)
        while mode is not None and mode not in passed:
            passed.add(mode)
            found = self._fallbacks[part, mode]
            if self._judge(part, found.new_target, now)[0] is None:
                break
            mode = self._guards.fallback_of(part, found.new_target)
        return found

    def _fall_back(self, fallback: Fallback, broken: Blocker, now: Instant) -> None:
        part = fallback.system
        way = self._displacing.way_ahead(fallback)
        since = now if broken.since is None else broken.since
        ground = Ground(broken.causes[0].message, (broken,), since, self._broken[part])
        earlier = self._acting.get(part)
        if earlier is not None:
            self._returns.forget(earlier)
        self._displacing.displace(fallback, way, ground, now, instead_of=earlier)
        self._acting[part] = fallback
        self._changes.pop(part, None)
        if self._parts.waits_for_operator(part) and self._displacing.would_activate(way):
            return
        # A fallback needs nothing of its own mode: what replaces it is its own fallback.
        self._changes[part] = self._displacing.set_out(fallback, way, now, is_guarded=False)

    def _of(self, displacer: object) -> Fallback:
        assert isinstance(displacer, Fallback)
        return displacer


def _with_invariants(parts: Parts) -> list[PartName]:
    """Return the parts that have invariants, outer systems before those in them."""
    settings = parts.model.mode_settings
    order = [*reversed(list(bottom_up(parts.model))), *parts.model.nodes]
    return [
        part for part in order if any(mode.invariants for mode in settings.get(part, {}).values())
    ]


def _fallbacks_of(parts: Parts) -> list[Fallback]:
    """Return the fallbacks of all modes."""
    return [
        Fallback(part, mode.fallback)
        for part, modes in parts.model.mode_settings.items()
        for mode in modes.values()
        if mode.fallback is not None
    ]
