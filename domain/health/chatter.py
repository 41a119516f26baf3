"""Errors that come and go: how often each turned of late, and what would calm it.

Source: EEMUA 191, chattering alarms.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, pairwise

from domain.deadlines import Deadlines
from domain.health.turns import Turn
from domain.snapshot import ErrorKey
from domain.timebase import Duration, Instant, seconds

WITHIN = seconds(600)
AT_MOST = 5
"""An error that turned more often within that time chatters; raised and ended are a turn each."""

_MOST_TURNS = 20
"""Turns that are remembered of an error; what calms it follows from these."""

_FORGETS_AT_ONCE = 2

_STEP = seconds(0.1)
"""A time that is advised is a multiple of it."""


@dataclass(frozen=True, slots=True)
class Chattering:
    """An error chatters."""

    calming: Duration
    """For how long its cause would have to be gone before it clears: longer than it was gone
    between any two turns that are remembered."""


class Chatter:
    """Counts turns by error; nothing has to be done at rest for those that are calm."""

    def __init__(self) -> None:
        self._turns: dict[ErrorKey, tuple[Turn, ...]] = {}
        """The newest turns, the oldest first; the error that turned last comes last."""
        self._deadlines: Deadlines[ErrorKey] = Deadlines()
        """When an error that chatters is calm again."""

    def __len__(self) -> int:
        """Return of how many errors turns are remembered."""
        return len(self._turns)

    def note(self, turn: Turn) -> None:
        """Note that an error was raised, or ended."""
        known = (old for old in self._turns.pop(turn.key, ()) if old.at + WITHIN > turn.at)
        turns = self._turns[turn.key] = (*known, turn)[-_MOST_TURNS:]
        if _chatters(turns):
            self._deadlines.set(turn.key, turns[-AT_MOST - 1].at + WITHIN)
        self._forget_some(turn.at)

    def find(self, key: ErrorKey) -> Chattering | None:
        """Return that an error chatters; None: it does not."""
        turns = self._turns.get(key, ())
        if key not in self._deadlines:
            return None
        longest = max(_gaps(turns), default=0)
        return Chattering((longest // _STEP + 1) * _STEP)

    def wake_at(self) -> Instant | None:
        """Return when time alone calms an error; None: never."""
        return self._deadlines.next()

    def pop_calm(self, now: Instant) -> ErrorKey | None:
        """Return an error that has calmed down, once; None: there is none."""
        return self._deadlines.pop_due(now)

    def _forget_some(self, now: Instant) -> None:
        """Forget errors that last turned too long ago: a few, since each turn does so."""
        for key in list(islice(self._turns, _FORGETS_AT_ONCE)):
            if self._turns[key][-1].at + WITHIN > now:
                return
            del self._turns[key]


def _chatters(turns: tuple[Turn, ...]) -> bool:
    """Tell whether there were too many turns within the time up to the last one."""
    return len(turns) > AT_MOST and turns[-1].at - turns[-AT_MOST - 1].at < WITHIN


def _gaps(turns: tuple[Turn, ...]) -> Iterator[Duration]:
    """Yield how long the cause of the error was gone between two turns."""
    for ended, raised in pairwise(turns):
        if raised.raised:
            yield raised.at - (ended.at if ended.gone is None else ended.gone)
