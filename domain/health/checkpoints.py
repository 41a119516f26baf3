"""Checkpoints: places in the program of a node at which it reports that it passes them.

They are supervised while the node is active: whether each is reached often enough and not too
often (alive), whether one follows another in time (deadline), and in which order they come (order).

Source: AUTOSAR, Specification of Watchdog Manager: alive, deadline and logical supervision.
"""

from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from domain.findings import Fact
from domain.health.built_in_errors import (
    CHECKPOINT_LATE,
    CHECKPOINT_TOO_FEW,
    CHECKPOINT_TOO_MANY,
    CHECKPOINT_WRONG_ORDER,
)
from domain.timebase import Duration, Instant, seconds, to_seconds

_TICK: Duration = 1
"""The shortest time: what may last as long as a limit is too long a tick later."""


@dataclass(frozen=True, slots=True)
class AliveLimits:
    """How often a checkpoint has to be reached."""

    checkpoint: str
    window: Duration
    """Time over which it is counted."""
    at_least: int = 0
    at_most: int | None = None
    """None: any number."""


@dataclass(frozen=True, slots=True)
class CheckpointDeadline:
    """How long it may take from one checkpoint to another one."""

    begin: str
    end: str
    within: Duration


@dataclass(frozen=True, slots=True)
class CheckpointSettings:
    """What is supervised of the checkpoints of one node."""

    alive: tuple[AliveLimits, ...] = ()
    deadlines: tuple[CheckpointDeadline, ...] = ()
    order: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Which checkpoints may come next after each; those that it does not name come at any time."""
    clear_for: Duration = seconds(1)
    """How long everything has to be in order before an error clears."""

    @property
    def names(self) -> tuple[str, ...]:
        """Return all checkpoints of the node."""
        found = [limits.checkpoint for limits in self.alive]
        for deadline in self.deadlines:
            found += (deadline.begin, deadline.end)
        for before, after in self.order.items():
            found += (before, *after)
        return tuple(dict.fromkeys(found))


class Problem(NamedTuple):
    """What is wrong with checkpoints."""

    message: str
    value: Fact
    threshold: Fact


class _Check(Protocol):
    """One thing that is supervised; of some checkpoints, for one error."""

    error: str
    names: frozenset[str]
    """The checkpoints that it is about."""
    problem: Problem | None
    """What is wrong; None: nothing is."""

    def begin(self, now: Instant) -> None:
        """Begin anew: nothing was reached so far."""
        ...

    def reach(self, name: str, now: Instant, *, is_late: bool) -> None:
        """Note that one of its checkpoints was reached; see `NodeCheckpoints.reach`."""
        ...

    def judge(self, now: Instant) -> None:
        """Judge what time alone changes."""
        ...

    def wake_at(self) -> Instant | None:
        """Return when time alone changes something; None: never."""
        ...


class NodeCheckpoints:
    """The checkpoints of one node, and what is wrong with them.

    Call `judge` at each `wake_at` and after each other method.
    """

    def __init__(self, settings: CheckpointSettings) -> None:
        """Prepare; nothing is supervised before `begin`."""
        self._clear_for = settings.clear_for
        self._checks = tuple(_checks(settings))
        self._of: Mapping[str, tuple[_Check, ...]] = {
            name: tuple(check for check in self._checks if name in check.names)
            for name in settings.names
        }
        self._is_on = False
        self._problems: dict[str, Problem] = {}
        """By error that is on, what is wrong or was so last."""
        self._clear_at: dict[str, Instant] = {}
        """Errors that clear unless something is wrong again before that."""

    @property
    def names(self) -> tuple[str, ...]:
        """Return all checkpoints."""
        return tuple(self._of)

    def begin(self, now: Instant) -> None:
        """Begin to supervise: the node has become active."""
        self._is_on = True
        for check in self._checks:
            check.begin(now)

    def pause(self) -> None:
        """Supervise no longer, as nothing is known of the node; errors stay as they are."""
        self._is_on = False
        self._clear_at.clear()

    def end(self, now: Instant) -> None:
        """Supervise no longer, as the node is not active; errors clear."""
        self._is_on = False
        self._clear_at = dict.fromkeys(self._problems, now)

    def reach(self, name: str, now: Instant, *, is_late: bool) -> None:
        """Note that a checkpoint was reached; without effect unless it is supervised.

        Args:
            name: One of `names`.
            now: When that became known.
            is_late: It was reached at an unknown time before, and heard late by our own fault.
        """
        if self._is_on:
            for check in self._of[name]:
                check.reach(name, now, is_late=is_late)

    def judge(self, now: Instant, *, is_late: bool = False) -> Mapping[str, Problem | None]:
        """Return what became of errors: what is wrong, or None for those that clear.

        Args:
            now: The current time.
            is_late: What is due is left to a later call, as checkpoints may have been reached in
                time and are not heard yet.
        """
        wrong: dict[str, Problem] = {}
        if self._is_on:
            for check in self._checks:
                if not is_late:
                    check.judge(now)
                if check.problem is not None:
                    wrong.setdefault(check.error, check.problem)
        changes: dict[str, Problem | None] = {}
        for error, problem in wrong.items():
            self._clear_at.pop(error, None)
            if self._problems.get(error) != problem:
                self._problems[error] = changes[error] = problem
        for error in tuple(self._problems):
            if error in wrong:
                continue
            if self._is_on:
                self._clear_at.setdefault(error, now + self._clear_for)
            if error in self._clear_at and self._clear_at[error] <= now:
                del self._problems[error], self._clear_at[error]
                changes[error] = None
        return changes

    def wake_at(self) -> Instant | None:
        """Return when time alone changes something; None: never."""
        due = list(self._clear_at.values())
        if self._is_on:
            due += (at for check in self._checks if (at := check.wake_at()) is not None)
        return min(due, default=None)


def _checks(settings: CheckpointSettings) -> Iterator[_Check]:
    for limits in settings.alive:
        if limits.at_least:
            yield _TooFew(limits.checkpoint, limits.window, limits.at_least)
        if limits.at_most is not None:
            yield _TooMany(limits.checkpoint, limits.window, limits.at_most)
    for deadline in settings.deadlines:
        yield _Late(deadline)
    if settings.order:
        yield _WrongOrder(settings.order)


class _TooFew:
    """Whether a checkpoint is reached often enough: at most `window` for the last `at_least`."""

    error = CHECKPOINT_TOO_FEW

    def __init__(self, checkpoint: str, window: Duration, at_least: int) -> None:
        self.names = frozenset((checkpoint,))
        self.problem: Problem | None = None
        self._checkpoint = checkpoint
        self._window = window
        self._at_least = at_least
        self._last: deque[Instant] = deque(maxlen=at_least)
        """When it was reached; in place of times before the start, the start."""

    def begin(self, now: Instant) -> None:
        self.problem = None
        self._last.extend([now] * self._at_least)

    def reach(self, name: str, now: Instant, *, is_late: bool) -> None:
        self._last.append(now)

    def judge(self, now: Instant) -> None:
        if now <= self._last[0] + self._window:
            self.problem = None
        elif self.problem is None:
            count = sum(at >= now - self._window for at in self._last)
            reached = f"reached {_times(count)}" if count else "not reached"
            words = (
                f"{self._checkpoint} was {reached} in {_in_s(self._window)}, and should have been "
                f"at least {_times(self._at_least)}"
            )
            self.problem = Problem(words, count, self._at_least)

    def wake_at(self) -> Instant | None:
        return None if self.problem else self._last[0] + self._window + _TICK


class _TooMany:
    """Whether a checkpoint is reached too often: more than `at_most` in less than `window`."""

    error = CHECKPOINT_TOO_MANY

    def __init__(self, checkpoint: str, window: Duration, at_most: int) -> None:
        self.names = frozenset((checkpoint,))
        self.problem: Problem | None = None
        self._window = window
        self._last: deque[Instant] = deque(maxlen=at_most + 1)
        words = f"{checkpoint} was reached more than {_times(at_most)} in {_in_s(window)}"
        self._wrong = Problem(words, at_most + 1, at_most)

    def begin(self, now: Instant) -> None:
        self.problem = None
        self._last.clear()

    def reach(self, name: str, now: Instant, *, is_late: bool) -> None:
        if is_late:
            # Those that waited for us come at once, and say nothing about how often it is reached.
            self._last.clear()
        self._last.append(now)

    def judge(self, now: Instant) -> None:
        self.problem = self._wrong if self._is_full() and now < self._ends_at() else None

    def wake_at(self) -> Instant | None:
        return self._ends_at() if self.problem else None

    def _is_full(self) -> bool:
        return len(self._last) == self._last.maxlen

    def _ends_at(self) -> Instant:
        return self._last[0] + self._window


class _Late:
    """Whether one checkpoint follows another in time; a run that is late stays so until one is not.

    A run begins with the first checkpoint, again and again without the second only once.
    """

    error = CHECKPOINT_LATE

    def __init__(self, deadline: CheckpointDeadline) -> None:
        self.names = frozenset((deadline.begin, deadline.end))
        self.problem: Problem | None = None
        self._deadline = deadline
        self._began: Instant | None = None
        words = (
            f"{deadline.end} was not reached within {_in_s(deadline.within)} of {deadline.begin}"
        )
        self._wrong = Problem(words, None, to_seconds(deadline.within))

    def begin(self, now: Instant) -> None:
        self.problem = self._began = None

    def reach(self, name: str, now: Instant, *, is_late: bool) -> None:
        if name == self._deadline.begin and self._began is None:
            self._began = now
        elif name == self._deadline.end and self._began is not None:
            self.problem = self._began = None

    def judge(self, now: Instant) -> None:
        if self._began is not None and now > self._began + self._deadline.within:
            self._began = None
            self.problem = self._wrong

    def wake_at(self) -> Instant | None:
        return None if self._began is None else self._began + self._deadline.within + _TICK


class _WrongOrder:
    """Whether each checkpoint is one of those that may follow the one before."""

    error = CHECKPOINT_WRONG_ORDER

    def __init__(self, order: Mapping[str, tuple[str, ...]]) -> None:
        self.names = frozenset((*order, *(name for names in order.values() for name in names)))
        self.problem: Problem | None = None
        self._order = order
        self._before: str | None = None

    def begin(self, now: Instant) -> None:
        self.problem = self._before = None

    def reach(self, name: str, now: Instant, *, is_late: bool) -> None:
        before, self._before = self._before, name
        self.problem = None
        if before is None:
            return
        expected = self._order.get(before, ())
        if name not in expected:
            wanted = " or ".join(expected) or "nothing"
            words = f"{name} was reached after {before}, and {wanted} should have been"
            self.problem = Problem(words, name, wanted)

    def judge(self, now: Instant) -> None:
        """Do nothing: time alone changes nothing."""

    def wake_at(self) -> Instant | None:
        return None


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _in_s(duration: Duration) -> str:
    return f"{to_seconds(duration):g} s"
