"""The errors that are raised by sources such as signals: which are active, and why."""

import bisect
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeAlias

from domain.deadlines import Deadlines
from domain.errors import InvalidValueError
from domain.findings import Blocker
from domain.health.signals import ESTOP, Raisable
from domain.snapshot import ErrorKey
from domain.timebase import Instant


class ErrorSource(Protocol):
    """Something that raises errors and clears them, such as the monitor of a signal."""

    @property
    def can_raise(self) -> Mapping[str, Raisable]:
        """Return the errors that it can raise, by the names that it gives them."""
        ...

    @property
    def is_on(self) -> bool:
        """Tell whether an error is active."""
        ...

    @property
    def errors(self) -> frozenset[str]:
        """Return the active errors."""
        ...

    @property
    def present(self) -> frozenset[str]:
        """Return the active errors whose cause is still present."""
        ...

    def reasons(self) -> Iterator[Blocker]:
        """Yield why errors are active, one reason per cause; its code is the error."""
        ...

    def acknowledge(self, error: str, now: Instant) -> None:
        """Acknowledge an error if it is active here."""
        ...

    def judge(self, now: Instant) -> None:
        """Raise and clear errors as of `now`."""
        ...

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never."""
        ...


class ErrorChanges(NamedTuple):
    """What became of the errors of some sources; each in the order of bits."""

    raised: tuple[ErrorKey, ...] = ()
    cleared: tuple[ErrorKey, ...] = ()
    explained: tuple[ErrorKey, ...] = ()
    """Errors that have other reasons than before, those that are raised and cleared among them."""


_Rank: TypeAlias = tuple[bool, bool, int, int, int]
"""Where a reason stands: no cause is left, it is no ESTOP, its error, its source, its place there.
"""


@dataclass(frozen=True, slots=True)
class _Noted:
    """What a source contributes."""

    errors: frozenset[str] = frozenset()
    present: frozenset[str] = frozenset()
    reasons: tuple[tuple[_Rank, Blocker], ...] = ()


_NOTHING = _Noted()


class ErrorRegistry:
    """All sources together. Several may raise the same error; it is active while one of them does.

    A source that changed is touched, and `renew` takes over what became of it. What is known of
    all is kept up to date, so that a change costs the same however many sources there are.
    """

    def __init__(self, sources: Iterable[ErrorSource]) -> None:
        """Join the sources; each is named by its position from here on.

        Raises:
            InvalidValueError: Two sources give the same error different bits.
        """
        self._sources = tuple(sources)
        self._bits = _joined_bits(self._sources)
        self.order: Mapping[ErrorKey, int] = {key: place for place, key in enumerate(self._bits)}
        """All errors that can be raised, and the place of each in the order of their bits."""
        self._noted = [_NOTHING] * len(self._sources)
        self._on: dict[ErrorKey, int] = {}
        """By active error, how many sources raise it."""
        self._present: dict[ErrorKey, int] = {}
        """By error whose cause is present, of how many sources it is."""
        self._reasons = _Reasons()
        """Of the errors that set a bit."""
        self._other_reasons = _Reasons()
        self._errors: tuple[str, ...] = ()
        self._code = 0
        self._touched: dict[int, None] = dict.fromkeys(range(len(self._sources)))
        self._deadlines: Deadlines[int] = Deadlines()
        self._wakes: list[Instant | None] = [None] * len(self._sources)
        """The deadline of each source, or an earlier one if it was postponed."""
        self._postponed: set[int] = set()
        self.renew()

    # --- what happens ----------------------------------------------------------------------------

    def touch(self, source: int) -> None:
        """Note that a source has changed, or may have."""
        self._touched[source] = None

    def is_touched(self, source: int) -> bool:
        """Tell whether a source was touched since the last `renew`."""
        return source in self._touched

    def postpone(self, source: int) -> None:
        """Note that a source of which nothing else changed has a later deadline, or none.

        Most are put off time and again, and so it is looked up when the earlier one comes up.
        """
        self._postponed.add(source)

    def replan(self, source: int, at: Instant | None) -> None:
        """Note the deadline of a source of which nothing else changed; None: it has none."""
        noted = self._wakes[source]
        if noted is not None and (at is None or at >= noted):
            self._postponed.add(source)
        else:
            self._set_deadline(source, at)

    def take_out(self, source: int) -> None:
        """Note that a source is judged by somebody else now, as if it were due."""
        self._set_deadline(source, None)
        self.touch(source)

    def touched(self) -> list[int]:
        """Return the sources that were touched since the last `renew`, in their order."""
        return sorted(self._touched)

    def acknowledge(self, error: ErrorKey, now: Instant) -> None:
        """Acknowledge an error in all sources."""
        for position, source in enumerate(self._sources):
            raisable = source.can_raise.get(error.error)
            if raisable is not None and raisable.key == error:
                source.acknowledge(error.error, now)
                self.touch(position)

    def judge(self, now: Instant) -> None:
        """Raise and clear the errors of the sources that are due."""
        while (due := self.next_wake()) is not None and due <= now:
            position = self._deadlines.pop_due(now)
            assert position is not None
            self._wakes[position] = None
            self._sources[position].judge(now)
            self.touch(position)

    def renew(self) -> ErrorChanges:
        """Take over what became of the sources that were touched."""
        was_on = set[ErrorKey]()
        explained = set[ErrorKey]()
        for position in self.touched():
            source, before = self._sources[position], self._noted[position]
            self._set_deadline(position, source.wake_at())
            if before is _NOTHING and not source.is_on:
                continue
            after = self._look(position, source)
            if after == before:
                continue
            can_raise = source.can_raise
            of_both = {can_raise[error].key for error in before.errors | after.errors}
            was_on |= {key for key in of_both - explained if key in self._on}
            explained |= of_both
            self._replace(position, before, after)
        self._touched.clear()
        if not explained:
            return ErrorChanges()
        ordered = sorted(explained, key=self.order.__getitem__)
        raised = tuple(key for key in ordered if key in self._on and key not in was_on)
        cleared = tuple(key for key in ordered if key not in self._on and key in was_on)
        if raised or cleared:
            self._list_errors()
        return ErrorChanges(raised, cleared, tuple(ordered))

    # --- what can be seen ------------------------------------------------------------------------

    @property
    def errors(self) -> tuple[str, ...]:
        """Return the names of the active errors that set a bit, in the order of their bits."""
        return self._errors

    @property
    def code(self) -> int:
        """Return the active errors as a bit mask."""
        return self._code

    @property
    def reasons(self) -> tuple[Blocker, ...]:
        """Return why errors that set a bit are active; the same object until it changes.

        ESTOP first, then by bit, those without a cause last.
        """
        return self._reasons.all()

    def is_on(self, error: ErrorKey) -> bool:
        """Tell whether an error is active."""
        return error in self._on

    def is_present(self, error: ErrorKey) -> bool:
        """Tell whether an error is active and its cause still present."""
        return error in self._present

    def reason(self, error: ErrorKey) -> Blocker:
        """Return the most urgent reason of an active error."""
        order, reasons = self.order[error], self._reasons_of(error)
        found = reasons.first(order, error.error) or reasons.first(order, error.error, kept=True)
        if found is None:
            raise KeyError(error)
        return found

    def next_wake(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never."""
        while (first := self._deadlines.first()) in self._postponed:
            assert first is not None
            self._postponed.discard(first)
            self._set_deadline(first, self._sources[first].wake_at())
        return self._deadlines.next()

    # --- inside ----------------------------------------------------------------------------------

    def _set_deadline(self, position: int, at: Instant | None) -> None:
        if at == self._wakes[position]:
            return
        self._wakes[position] = at
        if at is None:
            self._deadlines.clear(position)
        else:
            self._deadlines.set(position, at)

    def _look(self, position: int, source: ErrorSource) -> _Noted:
        errors = source.errors
        if not errors:
            return _NOTHING
        can_raise, present = source.can_raise, source.present
        reasons = []
        for place, reason in enumerate(source.reasons()):
            order = self.order[can_raise[reason.code].key]
            is_kept = reason.code not in present
            reasons.append(((is_kept, reason.code != ESTOP, order, position, place), reason))
        return _Noted(errors, present, tuple(reasons))

    def _replace(self, position: int, before: _Noted, after: _Noted) -> None:
        """Count what a source contributes now instead of what it contributed before."""
        can_raise = self._sources[position].can_raise
        for counts, old, new in (
            (self._on, before.errors, after.errors),
            (self._present, before.present, after.present),
        ):
            for error in new - old:
                _count(counts, can_raise[error].key, 1)
            for error in old - new:
                _count(counts, can_raise[error].key, -1)
        for rank, reason in before.reasons:
            self._reasons_of(can_raise[reason.code].key).remove(rank)
        for rank, reason in after.reasons:
            self._reasons_of(can_raise[reason.code].key).add(rank, reason)
        self._noted[position] = after

    def _reasons_of(self, error: ErrorKey) -> "_Reasons":
        return self._reasons if self._bits[error] else self._other_reasons

    def _list_errors(self) -> None:
        on = sorted((key for key in self._on if self._bits[key]), key=self.order.__getitem__)
        self._errors = tuple(key.name for key in on)
        self._code = 0
        for key in on:
            self._code |= self._bits[key]


class _Reasons:
    """Reasons in the order of their ranks."""

    def __init__(self) -> None:
        self._ranks: list[_Rank] = []
        self._reasons: list[Blocker] = []
        """In the same order."""
        self._all: tuple[Blocker, ...] | None = ()
        """None: to be put together anew."""

    def add(self, rank: _Rank, reason: Blocker) -> None:
        """Add a reason."""
        at = bisect.bisect_left(self._ranks, rank)
        self._ranks.insert(at, rank)
        self._reasons.insert(at, reason)
        self._all = None

    def remove(self, rank: _Rank) -> None:
        """Remove the reason at a rank."""
        at = bisect.bisect_left(self._ranks, rank)
        del self._ranks[at], self._reasons[at]
        self._all = None

    def first(self, order: int, code: str, *, kept: bool = False) -> Blocker | None:
        """Return the first reason of an error with a cause, or of one that is kept on without."""
        begin: _Rank = (kept, code != ESTOP, order, -1, -1)
        at = bisect.bisect_left(self._ranks, begin)
        if at == len(self._ranks) or self._ranks[at][:3] != begin[:3]:
            return None
        return self._reasons[at]

    def all(self) -> tuple[Blocker, ...]:
        """Return all of them; the same object until one changes."""
        if self._all is None:
            self._all = tuple(self._reasons)
        return self._all


def _count(counts: dict[ErrorKey, int], error: ErrorKey, step: int) -> None:
    left = counts.get(error, 0) + step
    if left:
        counts[error] = left
    else:
        del counts[error]


def _joined_bits(sources: Sequence[ErrorSource]) -> Mapping[ErrorKey, int]:
    """Return the bit of each error, in the order of bits; those without one come last."""
    bits: dict[ErrorKey, int] = {}
    for source in sources:
        for error, bit in source.can_raise.values():
            if bits.setdefault(error, bit) != bit:
                raise InvalidValueError(
                    f"error {error.name} has the bits {bits[error]} and {bit}", error.name
                )
    return dict(sorted(bits.items(), key=lambda item: (not item[1], item[1])))
