"""A concern: one subject that the core decides about, with its own inputs and its own state."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

from domain.timebase import Instant

Takers: TypeAlias = Mapping[type, Callable[[Any, Instant], None]]
"""What takes inputs, by their class; called with the input and the present."""

NOTHING: Takers = MappingProxyType({})


class Concern:
    """One subject of the core, such as parts, health or driving.

    `Supervision` hands each input to the concerns that take it, in their fixed order, and then lets
    all of them settle. A concern may read and call those before it, and knows none after it.
    """

    @property
    def takes(self) -> Takers:
        """Return what takes each class of input.

        The first concern in the order that takes a class owns it: it checks an input, raises
        `PilothouseError` with nothing changed if it refuses it, and begins it in the outbox. Those
        after it take what was accepted, and refuse nothing.
        """
        return NOTHING

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something here; None: never."""
        return None

    def pass_time(self, now: Instant) -> None:
        """Handle what became due up to now."""

    def settle(self, now: Instant) -> bool:
        """Follow what other concerns changed; return whether that changed something here."""
        return False


class NotSettledError(RuntimeError):
    """Concerns kept moving each other: a fault of the core, not of an input."""

    def __init__(self, moving: tuple[str, ...], rounds: int) -> None:
        super().__init__(f"not settled after {rounds} rounds; still moving: {', '.join(moving)}")
        self.moving = moving


def settle(concerns: Sequence[Concern], now: Instant, max_rounds: int) -> None:
    """Let concerns follow each other, round by round, until none of them moves any more.

    Raises:
        NotSettledError: They still move after `max_rounds`.
    """
    for _ in range(max_rounds):
        moving = [concern for concern in concerns if concern.settle(now)]
        if not moving:
            return
    raise NotSettledError(tuple(type(concern).__name__ for concern in moving), max_rounds)
