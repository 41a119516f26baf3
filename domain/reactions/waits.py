"""Conditions that must last for a time before something follows from them."""

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Generic, TypeVar

from domain.deadlines import Deadlines
from domain.timebase import Duration, Instant

KeyT = TypeVar("KeyT", bound=Hashable)


@dataclass(slots=True)
class Wait:
    """A condition that holds."""

    since: Instant
    cause: int
    """Id of the event with which it began to hold."""
    is_over: bool = False
    """It has lasted long enough."""
    is_idle: bool = False
    """Nothing follows from it any more."""
    is_told: bool = False
    """What keeps something from following was told."""
    was_stopped: bool = False
    """ESTOP was active meanwhile."""


class Waits(Generic[KeyT]):
    """One wait per key, such as a rule."""

    def __init__(self) -> None:
        self._waits: dict[KeyT, Wait] = {}
        self._deadlines: Deadlines[KeyT] = Deadlines()

    def note(
        self, key: KeyT, now: Instant, lasts: Duration, *, holds: bool, record: Callable[[], int]
    ) -> None:
        """Note whether the condition of a key holds.

        Args:
            key: Such as a rule.
            now: The current time.
            lasts: For how long it has to hold; what it began with counts.
            holds: Whether it does.
            record: Returns the id of the event with which it begins to hold.
        """
        if not holds:
            self.end(key)
        elif key not in self._waits:
            self._waits[key] = Wait(now, record())
            self._deadlines.set(key, now + lasts)

    def of(self, key: KeyT) -> Wait | None:
        """Return the wait of a key; None: its condition does not hold."""
        return self._waits.get(key)

    def restore(self, key: KeyT, wait: Wait) -> None:
        """Take over a wait that is over, of an earlier run."""
        self._waits[key] = wait

    def end(self, key: KeyT) -> None:
        """Note that the condition of a key does not hold; without effect if it did not."""
        if self._waits.pop(key, None) is not None:
            self._deadlines.clear(key)

    def postpone(self, key: KeyT, until: Instant) -> None:
        """Let a wait be over at a later time."""
        self._waits[key].is_over = False
        self._deadlines.set(key, until)

    def stop(self) -> None:
        """Note that ESTOP is active."""
        for wait in self._waits.values():
            wait.was_stopped = True

    def stop_since(self, now: Instant) -> None:
        """Note that ESTOP was active when the conditions began to hold that do so since now."""
        for wait in self._waits.values():
            wait.was_stopped |= wait.since == now

    def wake_at(self) -> Instant | None:
        """Return when the next wait is over; None: there is none."""
        return self._deadlines.next()

    def pass_time(self, now: Instant) -> None:
        """Note which waits are over."""
        while (key := self._deadlines.pop_due(now)) is not None:
            self._waits[key].is_over = True

    def over(self) -> list[tuple[KeyT, Wait]]:
        """Return the waits that are over and from which something may follow, with their keys."""
        return [item for item in self._waits.items() if item[1].is_over and not item[1].is_idle]
