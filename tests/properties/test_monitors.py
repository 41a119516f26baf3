"""Whatever is read and whichever mode a part is in, a monitor decides as a plain evaluator does."""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from domain.health import window_monitor
from domain.health.signals import (
    Bound,
    Comparison,
    ModeLimit,
    MonitorSettings,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import Input, NodeReport, Reading, Readings, TimePassed
from domain.lifecycle import LifecycleState
from domain.state_and_mode import ModeName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import to_seconds
from domain.windows.settings import Statistic, WindowSettings
from tests.support.models import BASE, actuation_model

STREAMS = 10_000 if os.environ.get("PILOTHOUSE_SOAK") == "1" else 200
FAST, SLOW = ModeName("FAST"), ModeName("SLOW")
UNKNOWN = ModeName("")
"""As if nobody could tell the mode."""

# Nanoseconds take the place of tenths of a second, so that the evaluator can look at each.
LENGTH = 20
OF_TIMES = (Statistic.GAP, Statistic.AGE, Statistic.STUCK_FOR)
LIMITS = {
    Statistic.MEAN: (3.37, 5.37),
    Statistic.MIN: (2.5, 3.5),
    Statistic.MAX: (6.5, 7.5),
    Statistic.STD: (1.37, 2.37),
    Statistic.RANGE: (3.5, 5.5),
    Statistic.COUNT: (2.5, 4.5),
    Statistic.RATE: (2.5e9 / LENGTH, 4.5e9 / LENGTH),
    Statistic.GAP: (to_seconds(6), to_seconds(9)),
    Statistic.AGE: (to_seconds(4), to_seconds(7)),
    Statistic.STUCK_FOR: (to_seconds(4), to_seconds(9)),
    Statistic.PERCENTILE: (5.37, 6.37),
}
"""Of each statistic two that are crossed often."""


@dataclass(frozen=True)
class Plan:
    """A monitor, and limits while the base is FAST and else."""

    window: WindowSettings
    fast: Bound | None
    other: Bound | None

    def declared(self) -> SignalSettings:
        limits = (ModeLimit(self.fast, BASE, FAST), ModeLimit(self.other))
        spec = SignalSpec("watched", SignalKind.NUMBER)
        monitor = MonitorSettings("load", self.window)
        return SignalSettings(spec, stale_after=0, min_on=0, monitor=monitor, limits=limits)


Act: TypeAlias = float | ModeName
"""A reading, or the mode that the base reports."""


@st.composite
def plans(draw: st.DrawFn) -> Plan:
    statistic = draw(st.sampled_from(sorted(LIMITS)))
    by_number = statistic in (Statistic.MEAN, Statistic.MAX, Statistic.STUCK_FOR)
    size = draw(st.sampled_from([None, 4])) if by_number else None
    window = WindowSettings(
        statistic=statistic,
        length=LENGTH if size is None else None,
        size=size,
        min_n=draw(st.integers(1, 3)),
        q=75.0 if statistic is Statistic.PERCENTILE else None,
    )

    def bound() -> Bound | None:
        comparison = draw(st.sampled_from([Comparison.ABOVE, Comparison.BELOW, None]))
        if comparison is None:
            return None
        bad, good = draw(st.permutations(LIMITS[statistic]))
        is_wide = (bad > good) is (comparison is Comparison.ABOVE) and draw(st.booleans())
        for_ = draw(st.sampled_from([0, 0, 5]))
        return Bound("HIGH", comparison, bad, good if is_wide else None, for_=for_)

    return Plan(window, bound(), bound())


@st.composite
def stories(draw: st.DrawFn) -> list[tuple[int, Act]]:
    now, story = 0, list[tuple[int, Act]]()
    for _ in range(draw(st.integers(1, 30))):
        now += draw(st.sampled_from([0, 1, 1, 2, 3, 5, 8, 25]))
        mode = st.sampled_from([FAST, SLOW, UNKNOWN])
        value = st.integers(0, 9).map(float)
        story.append((now, draw(st.one_of(value, value, value, mode))))
    return story


@dataclass
class Evaluator:
    """Computes everything anew at each instant."""

    plan: Plan
    bound: Bound | None = None
    read: list[tuple[int, float]] = field(default_factory=list)
    bad_since: int | None = None
    is_on: bool = False

    def __post_init__(self) -> None:
        self.bound = self.plan.other

    def act(self, act: Act, now: int) -> None:
        if isinstance(act, float):
            self.read.append((now, act))
            self.judge(now)
        elif act != UNKNOWN:
            bound = self.plan.fast if act == FAST else self.plan.other
            if bound is not self.bound:
                self.swap(bound, now)

    def swap(self, bound: Bound | None, now: int) -> None:
        was_on, self.bound, self.bad_since, self.is_on = self.is_on, bound, None, False
        value = self.value(now)
        if bound is None:
            return
        if was_on and (value is None or bound.is_met_by(value)):
            self.is_on = True
        self.judge(now)

    def judge(self, now: int) -> None:
        value = self.value(now)
        if value is None or self.bound is None:
            self.bad_since = None
        elif not self.bound.is_met_by(value, error_is_on=self.is_on):
            self.bad_since, self.is_on = None, False
        else:
            self.bad_since = now if self.bad_since is None else self.bad_since
            self.is_on = self.is_on or now - self.bad_since >= self.bound.for_

    def value(self, now: int) -> float | None:
        window = self.plan.window
        if window.size is not None:
            held = self.read[-window.size :]
        else:
            held = [(at, value) for at, value in self.read if at > now - LENGTH]
        if window.statistic in (Statistic.COUNT, Statistic.RATE, Statistic.GAP, Statistic.AGE):
            return of_arrivals(window.statistic, held, self.read, now) if now >= LENGTH else None
        if len(held) < window.min_n:
            return None
        if window.statistic is Statistic.STUCK_FOR:
            same = [at for at, value in changes(self.read)]
            return to_seconds(now - same[-1])
        return of_values(window.statistic, [value for _, value in held])


def changes(read: Sequence[tuple[int, float]]) -> Iterator[tuple[int, float]]:
    last = None
    for at, value in read:
        if value != last:
            yield at, value
        last = value


def of_arrivals(
    statistic: Statistic,
    held: Sequence[tuple[int, float]],
    read: Sequence[tuple[int, float]],
    now: int,
) -> float:
    silence = now - (read[-1][0] if read else 0)
    match statistic:
        case Statistic.COUNT:
            return float(len(held))
        case Statistic.RATE:
            return len(held) / to_seconds(LENGTH)
        case Statistic.AGE:
            return to_seconds(silence)
    gaps = np.diff([at for at, _ in held])
    return to_seconds(max(silence, int(gaps.max(initial=0))))


def of_values(statistic: Statistic, values: Sequence[float]) -> float:
    match statistic:
        case Statistic.MEAN:
            return float(np.mean(values))
        case Statistic.MIN:
            return min(values)
        case Statistic.MAX:
            return max(values)
        case Statistic.STD:
            return float(np.std(values))
        case Statistic.RANGE:
            return max(values) - min(values)
    return float(np.percentile(values, 75.0))


def input_of(act: Act) -> Input:
    if isinstance(act, float):
        return Readings((Reading("load", act),), "test")
    if act == UNKNOWN:
        return NodeReport(BASE, reachable=False)
    return NodeReport(BASE, LifecycleState.ACTIVE, act, reachable=True)


@pytest.fixture(autouse=True, scope="module")
def _computes_at_once() -> Iterator[None]:
    """Let values be computed at each instant: the usual 50 ms are longer than all of a story."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(window_monitor, "COMPUTED_EVERY", 0)
        patch.setattr(window_monitor, "LATEST", 0)
        yield


@given(plans(), stories())
@settings(max_examples=STREAMS)
def test_its_error_is_on_exactly_when_that_of_the_evaluator_is(
    plan: Plan, story: list[tuple[int, Act]]
) -> None:
    load = SignalSettings(SignalSpec("load", SignalKind.NUMBER), stale_after=0)
    usual = tuple(replace(item, stale_after=0) for item in default_signals())
    signals = SupervisionSettings((*usual, load, plan.declared()))
    core, evaluator = Supervision(actuation_model(), signals, 0), Evaluator(plan)
    now = 0
    for at, act in (*story, (story[-1][0] + 30, None)):
        for instant in range(now, at + 1):
            core.handle(TimePassed(), instant)
            evaluator.judge(instant)
            assert ("HIGH" in core.system_state().errors) is evaluator.is_on, (instant, act)
        now = at
        if act is not None:
            core.handle(input_of(act), at)
            evaluator.act(act, at)
            assert ("HIGH" in core.system_state().errors) is evaluator.is_on, (at, act)
            if isinstance(act, float):
                assert core.signal("watched").value == pytest.approx(evaluator.value(at))
