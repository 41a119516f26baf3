"""A concern: one subject of the core, with its own inputs and its own state."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, TypeAlias

from domain.timebase import Instant

Takers: TypeAlias = Mapping[type, Callable[[Any, Instant], None]]
"""Handlers by class of input; each is called with the input and the current time."""

NOTHING: Takers = MappingProxyType({})


class Concern:
    """One subject of the core, such as parts, health or driving.

    `Supervision` passes each input to the concerns that handle it, in a fixed order, and then lets
    all concerns settle. A concern may read and call those before it, and knows none after it.
    """

    @property
    def takes(self) -> Takers:
        """Return the handler of each class of input.

        The first concern in the order that handles a class owns it: it checks the input, rejects it
        by raising `PilothouseError` before anything changes, and begins it in the outbox. Those
        after it get accepted inputs only, and must not reject them.
        """
        return NOTHING

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something here; None: never."""
        return None

    def pass_time(self, now: Instant) -> None:
        """Handle all deadlines up to `now`."""

    @property
    def has_more(self) -> bool:
        """Tell whether an input left work that `go_on` continues."""
        return False

    def go_on(self, now: Instant) -> None:
        """Do the next portion of what an input left, so that no turn takes long."""

    def settle(self, now: Instant) -> bool:
        """React to changes of other concerns; return whether that changed anything here."""
        return False


class NotSettledError(RuntimeError):
    """Concerns keep changing each other: a bug in the core, not a fault of an input."""

    def __init__(self, moving: tuple[str, ...], rounds: int) -> None:
        super().__init__(f"not settled after {rounds} rounds; still changing: {', '.join(moving)}")
        self.moving = moving


def settle(concerns: Sequence[Concern], now: Instant, max_rounds: int) -> None:
    """Let concerns react to each other, round by round, until nothing changes any more.

    That is so once each has settled since the last one that changed something.

    Args:
        concerns: In their order.
        now: The current time.
        max_rounds: Limit on the number of rounds.

    Raises:
        NotSettledError: Concerns still change after `max_rounds`.
    """
    moving: list[Concern] = []
    quiet = 0
    for _ in range(max_rounds):
        moving = []
        for concern in concerns:
            if concern.settle(now):
                moving.append(concern)
                quiet = 0
                continue
            quiet += 1
            if quiet == len(concerns):
                return
    raise NotSettledError(tuple(type(concern).__name__ for concern in moving), max_rounds)


def takers_of(
    concerns: Sequence[Concern],
) -> Mapping[type, tuple[Callable[[Any, Instant], None], ...]]:
    """Return the handlers of each class of input, its owner first."""
    takers: dict[type, tuple[Callable[[Any, Instant], None], ...]] = {}
    for concern in concerns:
        for kind, take in concern.takes.items():
            takers[kind] = (*takers.get(kind, ()), take)
    return takers


def overrides(concern: Concern, method: str) -> bool:
    """Tell whether a concern overrides `method`; calling the empty ones would only cost time."""
    return getattr(type(concern), method) is not getattr(Concern, method)
