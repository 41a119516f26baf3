"""Whatever is read and whenever time passes, the state manager agrees with a slow, plain model."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from hypothesis import given
from hypothesis import strategies as st

from domain.errors import OutdatedReadingError
from domain.findings import Blocker
from domain.health.health_changes import HealthChanges
from domain.health.signal_monitor import StopCause
from domain.health.signals import (
    STALE_DATA,
    Bound,
    Comparison,
    Recovery,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.health.state_manager import StateManager
from domain.inputs import Reading, Readings, SignalValue
from domain.snapshot import ErrorKey, SignalView, SystemState, TaskStatus
from domain.timebase import Instant, seconds, to_seconds
from tests.support.health_reference import SECOND, HealthReference, Moment

START = 1_000

VALUES: Mapping[str, Sequence[SignalValue]] = {
    "battery_level": [0.3, 0.49, 0.5, 0.55, 0.6, 0.9],
    "estop": [False, True],
    "gps_accuracy": [100.0, 150.0, 170.0, 200.0, 201.0, 300.0],
    "signal_strength": ["CONNECTED", "LOW_SIGNAL", "NOT_CONNECTED"],
    "temperature": [20.0, 55.0, 56.0],
    "load": [1000.0, 1400.0, 1500.0, 1600.0, 1800.0],
}


LOAD = SignalSettings(
    SignalSpec("load", SignalKind.NUMBER, "kg"),
    (Bound("OVERLOAD", Comparison.ABOVE, 1500.0),),
)

Seen: TypeAlias = tuple[tuple[str, ...], tuple[Blocker, ...], Mapping[str, SignalView]]


@dataclass(frozen=True)
class Engage:
    engaged: bool


@dataclass(frozen=True)
class Acknowledge:
    error: str


Act: TypeAlias = Readings | Engage | Acknowledge

# Nanoseconds take the place of tenths of a second, so that the model can look at each.
recoveries = st.sampled_from(Recovery)
stale_afters = st.sampled_from([0, 9, 25])
min_ons = st.sampled_from([0, 1, 4])


@st.composite
def signal_settings(draw: st.DrawFn) -> tuple[SignalSettings, ...]:
    durations = {"GPS_LOST": 15, "SIGNAL_LOST": 10, "SIGNAL_LOW": 20, "OVERLOAD": 7}
    durations["BATTERY_LOW"] = draw(st.sampled_from([0, 5]))
    # Without and with hysteresis.
    hysteresis = {"BATTERY_LOW": 0.6, "GPS_LOST": 150.0, "OVERLOAD": 1300.0}
    clear = draw(st.sampled_from([{}, hysteresis]))
    made = []
    for item in (*default_signals(), LOAD):
        bounds = tuple(
            replace(
                bound,
                for_=durations.get(bound.error, 0),
                clear_threshold=clear.get(bound.error),
            )
            for bound in item.bounds
        )
        made.append(
            replace(
                item,
                bounds=bounds,
                stale_after=draw(stale_afters),
                min_on=draw(min_ons),
                recovery=draw(recoveries),
            )
        )
    return tuple(made)


@st.composite
def readings(draw: st.DrawFn, now: int) -> Readings:
    items = []
    for _ in range(draw(st.integers(1, 3))):
        signal = draw(st.sampled_from(sorted(VALUES)))
        value = draw(st.sampled_from(VALUES[signal]))
        ahead = draw(
            st.sampled_from([None, None, 0, 0, -1, -5, 3, SECOND, SECOND + 1, -2 * SECOND])
        )
        items.append(Reading(signal, value, None if ahead is None else now + ahead))
    return Readings(tuple(items), draw(st.sampled_from(["pad", "relay"])))


@st.composite
def stories(draw: st.DrawFn) -> list[tuple[int, Act]]:
    now = START
    story: list[tuple[int, Act]] = []
    for _ in range(draw(st.integers(1, 12))):
        now += draw(st.sampled_from([0, 0, 1, 2, 4, 5, 8, 9, 10, 16]))
        error = st.sampled_from(
            ["ESTOP", "BATTERY_LOW", "GPS_LOST", "SIGNAL_LOST", "OVERLOAD", STALE_DATA]
        )
        act = draw(
            st.one_of(
                readings(now),
                readings(now),
                readings(now),
                st.builds(Engage, st.booleans()),
                st.builds(Acknowledge, error),
            )
        )
        story.append((now, act))
    return story


@dataclass
class Told:
    """All that was told, in order."""

    raised: list[str] = field(default_factory=list)
    cleared: list[str] = field(default_factory=list)
    pending: list[tuple[str, str]] = field(default_factory=list)
    settled: list[tuple[str, str, bool]] = field(default_factory=list)
    skewed: list[str] = field(default_factory=list)
    signals: set[str] = field(default_factory=set)

    def add(self, changes: HealthChanges) -> None:
        self.raised += [key.name for key, _ in changes.raised]
        self.cleared += [key.name for key in changes.cleared]
        self.pending += changes.pending
        self.settled += changes.settled
        self.skewed += changes.skewed
        self.signals |= changes.signals


def do(health: StateManager, act: Act, now: int) -> HealthChanges | None:
    """Do one thing; return None if it is refused."""
    if isinstance(act, Engage):
        causes = (StopCause("emergency stop is engaged", now),) if act.engaged else ()
        return health.set_emergency_stop(causes, now)
    if isinstance(act, Acknowledge):
        return health.acknowledge(ErrorKey(None, act.error), now)
    try:
        health.check(act, now)
    except OutdatedReadingError:
        return None
    return health.receive(act, now)


def do_in_model(model: HealthReference, act: Act) -> bool:
    """Do the same; return False if it is refused."""
    if isinstance(act, Engage):
        model.engage(act.engaged)
    elif isinstance(act, Acknowledge):
        model.acknowledge(act.error)
    elif model.refuses(act):
        return False
    else:
        model.receive(act)
    return True


def seen_of(health: StateManager) -> Seen:
    reasons = health.system_state(TaskStatus.NO_TASK).reasons
    return health.errors, reasons, health.signals()


def moment_of(health: StateManager) -> Moment:
    views = health.signals()
    reasons = health.system_state(TaskStatus.NO_TASK).reasons
    return Moment(
        frozenset((reason.path[0], reason.code) for reason in reasons),
        {name: _pending(view) for name, view in views.items()},
        frozenset(name for name, view in views.items() if view.stale),
    )


def _pending(view: SignalView) -> tuple[str, Instant] | None:
    if view.pending_error is None or view.pending_since is None:
        return None
    return view.pending_error, view.pending_since


@given(signal_settings(), stories())
def test_every_decision_is_that_of_the_plain_model(
    declared: tuple[SignalSettings, ...], story: list[tuple[int, Act]]
) -> None:
    health, model = StateManager(declared, START), HealthReference(declared, START)
    for now, act in story:
        model.advance_to(now)
        taken = do(health, act, now) is not None
        assert taken is do_in_model(model, act)
        if taken:
            assert moment_of(health) == model.moment()


@given(signal_settings(), stories(), st.integers(0, 60))
def test_time_alone_changes_something_exactly_when_it_was_said_to(
    declared: tuple[SignalSettings, ...], story: list[tuple[int, Act]], rest: int
) -> None:
    health, model = StateManager(declared, START), HealthReference(declared, START)
    end = story[-1][0] + rest
    for (now, act), until in zip(story, [*(at for at, _ in story[1:]), end], strict=True):
        health.pass_time(now)
        model.advance_to(now)
        if do(health, act, now) is not None:
            do_in_model(model, act)
        before = model.moment()
        for instant, moment in model.advance_to(until):
            wake_at = health.wake_at()
            is_due = wake_at is not None and wake_at == instant
            assert (moment != before) is is_due
            before = moment
            if is_due:
                health.pass_time(instant)
            assert moment_of(health) == moment


@given(signal_settings(), stories(), st.data())
def test_letting_time_pass_more_often_changes_nothing(
    declared: tuple[SignalSettings, ...], story: list[tuple[int, Act]], data: st.DataObject
) -> None:
    seldom, often = StateManager(declared, START), StateManager(declared, START)
    told_seldom, told_often = Told(), Told()
    last = START
    for now, act in story:
        for instant in sorted(data.draw(st.lists(st.integers(last, now), max_size=4))):
            told_often.add(often.pass_time(instant))
        last = now
        for health, told in ((seldom, told_seldom), (often, told_often)):
            changes = do(health, act, now)
            # A refused reading changes nothing; the time until it still has passed.
            told.add(health.pass_time(now) if changes is None else changes)
        assert often.signals() == seldom.signals()
        for status in TaskStatus:
            assert often.system_state(status) == seldom.system_state(status)
    assert told_often == told_seldom


@given(signal_settings(), stories())
def test_what_is_told_adds_up_to_what_is_seen(
    declared: tuple[SignalSettings, ...], story: list[tuple[int, Act]]
) -> None:
    health = StateManager(declared, START)
    for before, changes in _steps(health, story):
        after = seen_of(health)
        assert set(after[0]) - set(before[0]) <= {key.name for key, _ in changes.raised}
        assert set(before[0]) - set(after[0]) <= {key.name for key in changes.cleared}
        assert changes.state_changed or before[:2] == after[:2]
        kept = {name for name, view in after[2].items() if view is before[2][name]}
        assert kept.isdisjoint(changes.signals)
        assert kept | changes.signals == set(after[2])
        assert (after[2] is before[2]) is not bool(changes.signals)


@given(signal_settings(), stories(), st.sampled_from(TaskStatus))
def test_the_robot_is_in_error_exactly_when_it_has_a_reason(
    declared: tuple[SignalSettings, ...], story: list[tuple[int, Act]], status: TaskStatus
) -> None:
    health = StateManager(declared, START)
    for _ in _steps(health, story):
        view = health.system_state(status)
        assert (view.state is SystemState.ERROR) is (view.error_code != 0)
        assert {reason.code for reason in view.reasons} == set(view.errors)
        assert not {"SIGNAL_LOST", "SIGNAL_LOW"} <= set(view.errors)


PIECES = st.lists(
    st.tuples(st.floats(0.01, 5.0), st.sampled_from([100.0, 1500.0, 1501.0, 1800.0])), max_size=30
)


@given(PIECES, st.sampled_from([0.5, 1.0, 3.0]), st.sampled_from([0.0, 2.0]))
def test_a_message_tells_only_what_was_measured(
    pieces: list[tuple[float, float]], for_s: float, stale_after_s: float
) -> None:
    """Whenever OVERLOAD is on, all readings of the time that is told were bad, and none too old."""
    bound = replace(LOAD.bounds[0], for_=seconds(for_s))
    load = replace(LOAD, bounds=(bound,), stale_after=seconds(stale_after_s), min_on=0)
    health, now = StateManager((*default_signals(), load), START), START
    read: list[tuple[Instant, float]] = []
    for after_s, value in pieces:
        now += seconds(after_s)
        health.receive(Readings((Reading("load", value),), "pad"), now)
        read.append((now, value))
        found = [reason for reason in health.reasons if reason.code == "OVERLOAD"]
        since = _bad_since(read, seconds(stale_after_s))
        if since is not None and now - since >= seconds(for_s):
            assert found, "bad for long enough"
        for reason in found:
            told = re.fullmatch(
                r"load \d+ kg has been above 1500 kg for ([\d.]+) s", reason.message
            )
            assert told is not None
            assert reason.since is not None
            earlier = [item for item in read if item[0] <= reason.since]
            began = _bad_since(earlier, seconds(stale_after_s))
            assert began is not None
            assert for_s <= float(told[1]) <= to_seconds(reason.since - began)


def _bad_since(read: Sequence[tuple[Instant, float]], stale_after: int) -> Instant | None:
    """Return since when all readings are bad, without a gap in which they were stale."""
    since, last = None, None
    for at, value in read:
        is_gap = bool(stale_after) and last is not None and at - last > stale_after
        since = None if value <= 1500 else at if since is None or is_gap else since
        last = at
    return since


def _steps(
    health: StateManager, story: list[tuple[int, Act]]
) -> Iterator[tuple[Seen, HealthChanges]]:
    """Do what the story says; yield what was seen before each act, and what it changed."""
    for now, act in story:
        health.pass_time(now)
        before = seen_of(health)
        changes = do(health, act, now)
        if changes is not None:
            yield before, changes
