"""Conditions that must last for a time before something follows from them."""

from collections.abc import Callable
from dataclasses import dataclass

from domain.deadlines import Deadlines
from domain.reactions.rule_watch import RuleWatch
from domain.timebase import Duration, Instant


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


class Waits:
    """One wait per rule."""

    def __init__(self, grace: Duration) -> None:
        self._grace = grace
        self._waits: dict[RuleWatch, Wait] = {}
        self._deadlines: Deadlines[RuleWatch] = Deadlines()

    def note(
        self, rule: RuleWatch, now: Instant, *, holds: bool, record: Callable[[], int]
    ) -> None:
        """Note whether the condition of a rule holds.

        Args:
            rule: The rule.
            now: The current time.
            holds: Whether it does.
            record: Returns the id of the event with which it begins to hold.
        """
        if not holds:
            self.end(rule)
        elif rule not in self._waits:
            self._waits[rule] = Wait(now, record())
            self._deadlines.set(rule, now + self._grace)

    def end(self, rule: RuleWatch) -> None:
        """Note that the condition of a rule does not hold; without effect if it did not."""
        if self._waits.pop(rule, None) is not None:
            self._deadlines.clear(rule)

    def postpone(self, rule: RuleWatch, until: Instant) -> None:
        """Let a wait be over at a later time."""
        self._waits[rule].is_over = False
        self._deadlines.set(rule, until)

    def stop(self) -> None:
        """Note that ESTOP is active."""
        for wait in self._waits.values():
            wait.was_stopped = True

    def wake_at(self) -> Instant | None:
        """Return when the next wait is over; None: there is none."""
        return self._deadlines.next()

    def pass_time(self, now: Instant) -> None:
        """Note which waits are over."""
        while (rule := self._deadlines.pop_due(now)) is not None:
            self._waits[rule].is_over = True

    def over(self) -> list[tuple[RuleWatch, Wait]]:
        """Return the waits that are over and from which something may follow, with their rules."""
        return [item for item in self._waits.items() if item[1].is_over and not item[1].is_idle]
