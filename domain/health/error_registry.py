"""The errors of the robot from all sources: which are active, and why."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Protocol

from domain.errors import InvalidValueError
from domain.findings import Blocker
from domain.health.signals import ESTOP
from domain.timebase import Instant


class ErrorSource(Protocol):
    """Something that raises errors and clears them, such as the monitor of a signal."""

    @property
    def bits(self) -> Mapping[str, int]:
        """Return the errors that it can raise, with the bit of each in the error code."""
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


class ErrorRegistry:
    """All sources together. Several may raise the same error; it is active while one of them does.

    Sources also change on their own inputs; the registry reflects that at once.
    """

    def __init__(self, sources: Iterable[ErrorSource]) -> None:
        """Join the sources.

        Raises:
            InvalidValueError: Two sources give the same error different bits.
        """
        self._sources = tuple(sources)
        self._bits = _joined_bits(self._sources)
        self._order = {error: position for position, error in enumerate(self._bits)}

    @property
    def names(self) -> tuple[str, ...]:
        """Return all errors that can be raised, in the order of their bits."""
        return tuple(self._bits)

    def errors(self) -> tuple[str, ...]:
        """Return the active errors, in the order of their bits."""
        on = frozenset[str]().union(*(source.errors for source in self._sources))
        return tuple(error for error in self._bits if error in on)

    @property
    def present(self) -> frozenset[str]:
        """Return the active errors whose cause is still present."""
        return frozenset[str]().union(*(source.present for source in self._sources))

    def code(self, errors: Iterable[str]) -> int:
        """Return errors as a bit mask."""
        code = 0
        for error in errors:
            code |= self._bits[error]
        return code

    def reasons(self) -> tuple[Blocker, ...]:
        """Return why errors are active: ESTOP first, then by bit, those without a cause last."""
        ranked = []
        for source in self._sources:
            for reason in source.reasons():
                is_kept = reason.code not in source.present
                rank = (is_kept, reason.code != ESTOP, self._order[reason.code])
                ranked.append((rank, reason))
        ranked.sort(key=lambda item: item[0])
        return tuple(reason for _, reason in ranked)

    def acknowledge(self, error: str, now: Instant) -> None:
        """Acknowledge an error in all sources."""
        for source in self._sources:
            source.acknowledge(error, now)

    def judge(self, now: Instant) -> None:
        """Raise and clear errors as of `now`."""
        for source in self._sources:
            source.judge(now)

    def next_wake(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never."""
        due = (source.wake_at() for source in self._sources)
        return min((at for at in due if at is not None), default=None)


def _joined_bits(sources: Iterable[ErrorSource]) -> Mapping[str, int]:
    """Return the bit of each error, in the order of bits."""
    bits: dict[str, int] = {}
    for source in sources:
        for error, bit in source.bits.items():
            if bits.setdefault(error, bit) != bit:
                raise InvalidValueError(
                    f"error {error} has the bits {bits[error]} and {bit}", error
                )
    return dict(sorted(bits.items(), key=lambda item: item[1]))
