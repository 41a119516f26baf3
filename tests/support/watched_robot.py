"""A robot that is well, with signals and monitors of its own, for stories told in seconds."""

from dataclasses import replace

from domain.events.event import RecordedEvent
from domain.health.health import Health
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
from domain.inputs import Reading, Readings, SignalValue
from domain.outbox import Outbox
from domain.snapshot import MonitorView, SignalView
from domain.timebase import Instant, seconds, to_seconds
from domain.windows.settings import Statistic, Threshold, WindowSettings
from tests.support.good import GOOD


def signal(name: str = "load", **settings: object) -> SignalSettings:
    """Return a number that is only read, and never stale."""
    made = SignalSettings(SignalSpec(name, SignalKind.NUMBER), stale_after=0, min_on=0)
    return replace(made, **settings)  # type: ignore[arg-type]  # as the caller says


def monitor(
    statistic: Statistic,
    *bounds: Bound,
    name: str = "watched",
    of: str = "load",
    window_s: float | None = 5.0,
    window_n: int | None = None,
    min_n: int = 2,
    limits: tuple[ModeLimit, ...] = (),
) -> SignalSettings:
    """Return a monitor."""
    window = WindowSettings(
        statistic=statistic,
        length=None if window_s is None else seconds(window_s),
        size=window_n,
        min_n=min_n,
        q=90.0 if statistic is Statistic.PERCENTILE else None,
        limit=Threshold(0.2, above=False) if statistic is Statistic.TIME_TO_LIMIT else None,
    )
    return signal(name, bounds=bounds, monitor=MonitorSettings(of, window), limits=limits)


def above(limit: float, error: str = "HIGH", for_s: float = 0.0) -> Bound:
    """Return a bound above which values are bad."""
    return Bound(error, Comparison.ABOVE, limit, for_=seconds(for_s))


def below(limit: float, error: str = "LOW", for_s: float = 0.0) -> Bound:
    """Return a bound below which values are bad."""
    return Bound(error, Comparison.BELOW, limit, for_=seconds(for_s))


class WatchedRobot:
    """Its health alone."""

    def __init__(self, *signals: SignalSettings) -> None:
        usual = (replace(item, stale_after=0) for item in default_signals())
        self.outbox = Outbox()
        self.health = Health([*usual, *signals], self.outbox, 0)
        self.now: Instant = 0
        self.wakes = 0
        """How often time alone led to something."""
        self.read(0, **GOOD)

    def read(self, at_s: float, **values: SignalValue) -> tuple[RecordedEvent, ...]:
        """Let time pass, and then take readings."""
        self.pass_time(at_s)
        items = tuple(Reading(name, value) for name, value in values.items())
        self.health.take_readings(Readings(items, "test"), self.now)
        return self.outbox.take().events

    def pass_time(self, at_s: float) -> list[float]:
        """Let time pass as the core does; return the times of its deadlines, in seconds."""
        until, deadlines = seconds(at_s), list[float]()
        while (due := self.health.wake_at()) is not None and due <= until:
            self.health.pass_time(due)
            deadlines.append(to_seconds(due))
        self.now = until
        return deadlines

    def signal(self, name: str = "watched") -> SignalView:
        """Return a signal."""
        return self.health.signal(name)

    def value(self, name: str = "watched") -> SignalValue | None:
        """Return the value of a signal."""
        return self.signal(name).value

    def errors(self) -> tuple[str, ...]:
        """Return the errors that set a bit."""
        return self.health.errors

    def monitor(self, name: str = "watched") -> MonitorView:
        """Return a monitor."""
        return next(view for view in self.health.monitors(self.now) if view.signal == name)
