"""How often reactions have acted, and may still act."""

from collections.abc import Iterable

from domain.deadlines import Deadlines
from domain.reactions.reaction import Reaction
from domain.timebase import Duration, Instant


class Budgets:
    """When each reaction acted, as long as that counts."""

    def __init__(self) -> None:
        self._used: dict[Reaction, tuple[Instant, ...]] = {}
        """The oldest first."""
        self._deadlines: Deadlines[Reaction] = Deadlines()
        """When the oldest does not count any more."""

    def left(self, reaction: Reaction) -> int | None:
        """Return how often a reaction may still act; None: at any time."""
        if not reaction.declared.action.has_budget:
            return None
        return max(0, reaction.declared.budget.at_most - len(self._used.get(reaction, ())))

    def is_spent(self, reaction: Reaction, now: Instant) -> bool:
        """Tell whether a reaction must not act.

        It may act only once at one moment: one that ends at once, and begins again, would never let
        the moment pass.
        """
        used = self._used.get(reaction, ())
        return self.left(reaction) == 0 or (bool(used) and used[-1] == now)

    def note(self, reaction: Reaction, now: Instant) -> None:
        """Note that a reaction acts."""
        if reaction.declared.action.has_budget:
            self._set(reaction, (*self._used.get(reaction, ()), now))

    def refill(self, reaction: Reaction) -> None:
        """Forget that a reaction acted."""
        self._set(reaction, ())

    def wake_at(self) -> Instant | None:
        """Return when one that acted counts no more; None: none counts."""
        return self._deadlines.next()

    def pass_time(self, now: Instant) -> list[Reaction]:
        """Let those count no more whose time is up; return the reactions that may act again."""
        freed = []
        while (reaction := self._deadlines.pop_due(now)) is not None:
            within = reaction.declared.budget.within
            self._set(reaction, (at for at in self._used[reaction] if at + within > now))
            freed.append(reaction)
        return freed

    # --- over a restart --------------------------------------------------------------------------

    def ages(self, reaction: Reaction, now: Instant) -> tuple[Duration, ...]:
        """Return how long ago a reaction acted, each time that counts."""
        return tuple(now - at for at in self._used.get(reaction, ()))

    def restore(self, reaction: Reaction, ages: Iterable[Duration], now: Instant) -> None:
        """Note when a reaction acted in an earlier run; no time has passed since that ended."""
        self._set(reaction, (now - age for age in ages))

    # --- inside ----------------------------------------------------------------------------------

    def _set(self, reaction: Reaction, used: Iterable[Instant]) -> None:
        times = tuple(used)
        if times:
            self._used[reaction] = times
            self._deadlines.set(reaction, times[0] + reaction.declared.budget.within)
        else:
            self._used.pop(reaction, None)
            self._deadlines.clear(reaction)
