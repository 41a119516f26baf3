"""How often things of one kind may happen within a time, also over a restart."""

from collections.abc import Collection, Iterable

from domain.deadlines import Deadlines
from domain.kept import Kept, KeptBound
from domain.outbox import Outbox
from domain.reactions.settings import WINDOW
from domain.timebase import Instant


class Bounds:
    """Each of them at most so many times within a sliding window.

    While the service is down, no time passes: to kill it does not make them free again.
    """

    def __init__(self, kind: str, names: Collection[str], most: int, outbox: Outbox) -> None:
        """Begin with nothing that happened.

        Args:
            kind: What they are, as a word that never changes.
            names: All of that kind that the model has.
            most: How often each may happen within `WINDOW`.
            outbox: Keeps when they happened.
        """
        self._kind = kind
        self._names = frozenset(names)
        self._most = most
        self._outbox = outbox
        self._at: dict[str, tuple[Instant, ...]] = {}
        """The last times within the window, not more than may be."""
        self._deadlines: Deadlines[str] = Deadlines()
        """When the last time does not count any more."""

    def free_at(self, name: str, now: Instant) -> Instant:
        """Return when it may happen next; `now`, if it may at once."""
        times = self._at.get(name, ())
        return now if len(times) < self._most else max(now, times[0] + WINDOW)

    def note(self, name: str, now: Instant) -> None:
        """Note that it happens."""
        self._set(name, (*self._at.get(name, ()), now), now)
        ages = tuple(now - at for at in self._at[name])
        self._outbox.keep(KeptBound(self._kind, name, ages))

    def wake_at(self) -> Instant | None:
        """Return when the next one counts no more; None: none counts."""
        return self._deadlines.next()

    def pass_time(self, now: Instant) -> None:
        """Forget what does not count any more."""
        while (name := self._deadlines.pop_due(now)) is not None:
            del self._at[name]
            self._outbox.forget(KeptBound, f"{self._kind}:{name}")

    def restore(self, kept: Iterable[Kept], now: Instant) -> None:
        """Note what happened in an earlier run; forget what the model no longer has."""
        for value in kept:
            if not isinstance(value, KeptBound) or value.kind != self._kind:
                continue
            if value.bounded in self._names and value.ages:
                self._set(value.bounded, tuple(now - age for age in value.ages), now)
            else:
                self._outbox.forget(KeptBound, value.name)

    def _set(self, name: str, times: Iterable[Instant], now: Instant) -> None:
        counting = [at for at in times if at + WINDOW > now]
        self._at[name] = tuple(counting[-self._most :])
        self._deadlines.set(name, self._at[name][-1] + WINDOW)
