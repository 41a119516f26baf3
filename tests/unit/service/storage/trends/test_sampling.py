"""Which changes of a view are readings."""

from dataclasses import dataclass, field

import pytest

from domain.inputs import SignalValue
from domain.snapshot import SignalView
from domain.timebase import Instant
from service.storage.trends.sampling import Sampling
from service.storage.trends.trends import Trends

NEVER_SEEN = SignalView(
    signal="load",
    value=None,
    unit="kg",
    source=None,
    received_at=None,
    stamp=None,
    stale=True,
    error=None,
    pending_error=None,
    pending_since=None,
    pending_needs=None,
    skewed=False,
    needs_acknowledgement=False,
    settings={},
)
SEEN = NEVER_SEEN._replace(value=7.0, received_at=100, stale=False)


@dataclass
class _Signal(Trends):
    """Its view, and what was noted of it."""

    view: SignalView = NEVER_SEEN
    noted: list[tuple[Instant, SignalValue, str | None]] = field(default_factory=list)

    def note(self, signal: str, at: Instant, value: SignalValue, error: str | None) -> None:
        self.noted.append((at, value, error))

    def becomes(self, sampling: Sampling, view: SignalView, at: Instant) -> None:
        self.view = view
        sampling.note(["load"], at)


@pytest.fixture
def signal() -> _Signal:
    return _Signal()


@pytest.fixture
def sampling(signal: _Signal) -> Sampling:
    return Sampling(signal, lambda _: signal.view)


def test_each_reading_counts_once(signal: _Signal, sampling: Sampling) -> None:
    signal.becomes(sampling, NEVER_SEEN, 50)
    signal.becomes(sampling, SEEN, 100)
    signal.becomes(sampling, SEEN._replace(skewed=True), 150)
    signal.becomes(sampling, SEEN._replace(received_at=200), 200)

    assert signal.noted == [(100, 7.0, None), (200, 7.0, None)]


def test_two_readings_of_one_moment_are_two(signal: _Signal, sampling: Sampling) -> None:
    signal.becomes(sampling, SEEN, 100)
    signal.becomes(sampling, SEEN._replace(value=99.0), 100)

    assert [value for _, value, _ in signal.noted] == [7.0, 99.0]


def test_an_error_that_time_alone_raises_is_not_missed(signal: _Signal, sampling: Sampling) -> None:
    signal.becomes(sampling, SEEN, 100)
    signal.becomes(sampling, SEEN._replace(error="LOST"), 500)
    signal.becomes(sampling, SEEN, 600)

    assert signal.noted == [(100, 7.0, None), (500, 7.0, "LOST")]


def test_a_silent_signal_has_no_readings(signal: _Signal, sampling: Sampling) -> None:
    signal.becomes(sampling, SEEN, 100)
    signal.becomes(sampling, SEEN._replace(stale=True), 500)
    signal.becomes(sampling, SEEN._replace(stale=True, error="ESTOP"), 600)

    assert signal.noted == [(100, 7.0, None)]
