"""Errors of checkpoints are those of somebody who looks at the whole past at every moment."""

import os
from collections.abc import Sequence
from typing import NamedTuple

from hypothesis import given, settings
from hypothesis import strategies as st

from domain.health.built_in_errors import (
    CHECKPOINT_LATE,
    CHECKPOINT_TOO_FEW,
    CHECKPOINT_TOO_MANY,
    CHECKPOINT_WRONG_ORDER,
)
from domain.health.checkpoints import (
    AliveLimits,
    CheckpointDeadline,
    CheckpointSettings,
    NodeCheckpoints,
)
from domain.timebase import Instant

PROGRAMS = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 300

GRID = 10_000_000
"""Everything happens at multiples of 10 ms; somebody looks in the middle between two of them."""
MOMENTS = 80
NAMES = ("a", "b", "c")
BEGIN, PAUSE, END = "begin", "pause", "end"

names = st.sampled_from(NAMES)
spans = st.integers(1, 12).map(lambda count: count * GRID)


class Happening(NamedTuple):
    """A checkpoint that is reached, or what becomes of the node."""

    at: Instant
    what: str


@st.composite
def all_settings(draw: st.DrawFn) -> CheckpointSettings:
    alive = draw(
        st.lists(
            st.builds(
                AliveLimits,
                names,
                spans,
                st.integers(0, 4),
                st.none() | st.integers(1, 6),
            ),
            max_size=2,
        )
    )
    deadlines = draw(
        st.lists(
            st.builds(CheckpointDeadline, names, names, spans).filter(lambda d: d.begin != d.end),
            max_size=2,
        )
    )
    followers = st.lists(names, min_size=1, unique=True).map(tuple)
    order = draw(st.dictionaries(names, followers))
    return CheckpointSettings(tuple(alive), tuple(deadlines), order, draw(spans))


happenings = st.dictionaries(
    st.integers(0, MOMENTS - 1), st.sampled_from((*NAMES * 5, BEGIN, PAUSE, END))
).map(lambda found: [Happening(at * GRID, what) for at, what in sorted(found.items())])


@settings(max_examples=PROGRAMS, deadline=None)
@given(all_settings(), happenings)
def test_errors_are_on_when_a_look_at_the_past_finds_them(
    own: CheckpointSettings, happened: list[Happening]
) -> None:
    assert _by_the_core(own, happened) == _by_hindsight(own, happened)


# --- as the core does it -------------------------------------------------------------------------


def _by_the_core(own: CheckpointSettings, happened: Sequence[Happening]) -> list[set[str]]:
    """Return which errors are on at each moment."""
    checkpoints = NodeCheckpoints(own)
    on: set[str] = set()
    seen = []
    coming = list(happened)

    def judge(now: Instant) -> None:
        for error, problem in checkpoints.judge(now).items():
            (on.discard if problem is None else on.add)(error)

    for moment in range(MOMENTS):
        look_at = moment * GRID + GRID // 2
        while True:
            due = checkpoints.wake_at()
            at = coming[0].at if coming else look_at
            if due is not None and due <= min(at, look_at):
                judge(due)
            elif coming and at <= look_at:
                _let_happen(checkpoints, coming.pop(0))
                judge(at)
            else:
                break
        seen.append(set(on))
    return seen


def _let_happen(checkpoints: NodeCheckpoints, happening: Happening) -> None:
    match happening.what:
        case "begin":
            checkpoints.begin(happening.at)
        case "pause":
            checkpoints.pause()
        case "end":
            checkpoints.end(happening.at)
        case name if name in checkpoints.names:
            checkpoints.reach(name, happening.at, is_late=False)


# --- as somebody does it who knows the past ------------------------------------------------------


def _by_hindsight(own: CheckpointSettings, happened: Sequence[Happening]) -> list[set[str]]:
    """Return which errors are on at each moment, by looking at all that happened before.

    An error clears once nothing was wrong for long enough while the node was supervised, or when
    the node is deactivated.
    """
    left: dict[str, int | None] = {}
    """By error that is on, after how many moments it clears; None: something is still wrong."""
    seen = []
    state = PAUSE
    for moment in range(MOMENTS):
        if state == BEGIN:
            left = {error: None if n is None else n - 1 for error, n in left.items() if n != 1}
        now = moment * GRID + GRID // 2
        before = [each for each in happened if each.at <= now]
        state = next((e.what for e in reversed(before) if e.what in (BEGIN, PAUSE, END)), PAUSE)
        if state == END:
            left.clear()
        elif state == PAUSE:
            left = dict.fromkeys(left)
        else:
            wrong = _wrong(own, before, now)
            well_for = own.clear_for // GRID
            left = {error: well_for if n is None else n for error, n in left.items()}
            left |= dict.fromkeys(wrong)
        seen.append(set(left))
    return seen


def _wrong(own: CheckpointSettings, before: Sequence[Happening], now: Instant) -> set[str]:
    """Return what is wrong at a moment with a node that is active."""
    (*_, began) = (number for number, each in enumerate(before) if each.what == BEGIN)
    start = before[began].at
    reached = [(at, what) for at, what in before[began:] if what in NAMES]
    wrong = set()
    for limits in own.alive:
        times = [at for at, name in reached if name == limits.checkpoint]
        since = now - limits.window
        if start < since and sum(at >= since for at in times) < limits.at_least:
            wrong.add(CHECKPOINT_TOO_FEW)
        if limits.at_most is not None and sum(at > since for at in times) > limits.at_most:
            wrong.add(CHECKPOINT_TOO_MANY)
    if any(_is_late(deadline, reached, now) for deadline in own.deadlines):
        wrong.add(CHECKPOINT_LATE)
    ordered = {name for pair in own.order.items() for name in (pair[0], *pair[1])}
    last = [name for _, name in reached if name in ordered][-2:]
    if len(last) == 2 and last[1] not in own.order.get(last[0], ()):
        wrong.add(CHECKPOINT_WRONG_ORDER)
    return wrong


def _is_late(
    deadline: CheckpointDeadline, reached: Sequence[tuple[Instant, str]], now: Instant
) -> bool:
    """Tell whether the last run that ended, or whose time is up, was late."""
    late, began = False, None
    for at, name in (*reached, (now, "")):
        if began is not None and at > began + deadline.within:
            late, began = True, None
        if name == deadline.begin and began is None:
            began = at
        elif name == deadline.end and began is not None:
            late, began = False, None
    return late
