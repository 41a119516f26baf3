"""When a displaced part returns.

Never under ESTOP or because of its end, never by itself after a restart, and not too often.
"""

from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

from domain.findings import Blocker
from domain.health.signals import ESTOP
from domain.kept import Kept
from domain.outbox import Outbox
from domain.parts.parts import Parts
from domain.reactions.bounds import Bounds
from domain.reactions.displacer import Displacer
from domain.reactions.displacing import Displacing
from domain.reactions.settings import MAX_RETURNS, RETRY, WINDOW
from domain.reactions.waits import Wait, Waits
from domain.timebase import Duration, Instant, to_seconds

RESTART = "RESTART"
"""Code of the blocker that says that a restart keeps a part from returning."""
TOO_OFTEN = "TOO_OFTEN"
"""Code of the blocker that says that a part has returned too often."""

UNTIL = "until a change of it is requested"
RESTARTED = f"the service was restarted: nothing is activated or returns {UNTIL}"
STOPPED = f"ESTOP was active: nothing is made up for {UNTIL}"
WITHIN = f"within {to_seconds(WINDOW):g} s"

DisplacerT = TypeVar("DisplacerT", bound=Displacer)


class Returns(Generic[DisplacerT]):
    """Lets parts return whose displacements have no cause any more."""

    def __init__(
        self,
        parts: Parts,
        displacing: Displacing,
        outbox: Outbox,
        is_free: Callable[[DisplacerT], bool],
        bounds: Bounds | None = None,
    ) -> None:
        """Begin without a displacement.

        Args:
            parts: Tell which parts wait for an operator.
            displacing: What is displaced.
            outbox: Receives events.
            is_free: Tells whether no change keeps a part from returning now.
            bounds: How often a part may return within a time; None: at any time.
        """
        self._parts = parts
        self._displacing = displacing
        self._outbox = outbox
        self._is_free = is_free
        self._relieved: Waits[DisplacerT] = Waits()
        """Displacements whose cause is gone."""
        self._bounds = bounds
        self._staying: set[DisplacerT] = set()
        """Displacements that nothing but a request ends."""

    def note(self, displacer: DisplacerT, now: Instant, lasts: Duration, *, is_gone: bool) -> None:
        """Note whether the cause of a displacement is gone; it has to be for a time."""
        holds = is_gone and displacer not in self._staying
        record = self._outbox.record_input
        self._relieved.note(displacer, now, lasts, holds=holds, record=record)

    def stays(self, displacer: DisplacerT) -> bool:
        """Tell whether nothing but a request ends a displacement."""
        return displacer in self._staying

    def forget(self, displacer: DisplacerT) -> None:
        """Forget a displacement that has ended."""
        self._relieved.end(displacer)
        self._staying.discard(displacer)

    def stop(self) -> None:
        """Note that ESTOP is active."""
        self._relieved.stop()

    def end_stop(self, now: Instant) -> None:
        """Note that ESTOP ends now: what is gone because of that does not count."""
        self._relieved.stop_since(now)

    def wake_at(self) -> Instant | None:
        """Return when the next cause has been gone for long enough, or a return counts no more."""
        times = (self._relieved.wake_at(), None if self._bounds is None else self._bounds.wake_at())
        return min((at for at in times if at is not None), default=None)

    def pass_time(self, now: Instant) -> None:
        """Note which causes have been gone for long enough."""
        self._relieved.pass_time(now)
        if self._bounds is not None:
            self._bounds.pass_time(now)

    def restore(self, kept: Iterable[Kept], now: Instant) -> None:
        """Note how often parts returned in an earlier run."""
        if self._bounds is not None:
            self._bounds.restore(kept, now)

    def act(self, now: Instant) -> bool:
        """Let the first part return that may; return whether one did, or what is shown changed."""
        return any(
            self._return(displacer, wait, now)
            for displacer, wait in self._relieved.over()
            if self._is_free(displacer)
        )

    def _return(self, displacer: DisplacerT, wait: Wait, now: Instant) -> bool:
        """Let a part return, or say why it stays; return whether that is something new."""
        way = self._displacing.way_back(displacer)
        if way is None:
            self.forget(displacer)
            self._displacing.take_back(displacer, way, wait.cause, now)
            return True
        if (stays := self._why_staying(displacer, wait, now)) is not None:
            self._relieved.end(displacer)
            self._staying.add(displacer)
            self._displacing.let_stay(displacer, stays, wait.cause, now)
            return True
        if obstacles := self._displacing.obstacles(way):
            self._relieved.postpone(displacer, now + RETRY)
            return self._displacing.explain(displacer, obstacles)
        self.forget(displacer)
        if self._bounds is not None:
            self._bounds.note(displacer.system, now)
        self._displacing.take_back(displacer, way, wait.cause, now)
        return True

    def _why_staying(self, displacer: DisplacerT, wait: Wait, now: Instant) -> Blocker | None:
        """Return what keeps a part from returning until a request; None: nothing does."""
        system = displacer.system
        often = f"it has returned {MAX_RETURNS} times {WITHIN}: it stays {UNTIL}"
        if wait.was_stopped:
            code, why = ESTOP, STOPPED
        elif self._parts.waits_for_operator(system):
            code, why = RESTART, RESTARTED
        elif self._bounds is not None and self._bounds.free_at(system, now) > now:
            code, why = TOO_OFTEN, often
        else:
            return None
        return Blocker(code, why, (system,), since=now, refuses=False)
