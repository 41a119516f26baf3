"""Readings, and the monitors that they go to."""

from domain.health.feed import Feed
from domain.health.good_range import GoodRange
from domain.timebase import Instant
from domain.windows.settings import Statistic, WindowSettings


class Monitor:
    """It owes taking account of a reading 50 after it, or at once of one that is large."""

    def __init__(self, feed: Feed) -> None:
        self.harmless = GoodRange(highest=10.0)
        self.owed_at: Instant | None = None
        self._joined = feed
        feed.join(self)

    @property
    def owed_until(self) -> Instant | None:
        return None if self.owed_at is None else self.owed_at + 50

    def feed(self, value: float, now: Instant) -> bool:
        self.owed_at = now if value > self.harmless.highest else now + 50
        return self.owed_at <= now

    def judge(self) -> None:
        self.owed_at = None
        self._joined.note_judged()


def fed(feed: Feed, *monitors: Monitor, value: float, now: Instant) -> bool:
    """Take in a reading as the state manager does; tell whether monitors were fed."""
    has_to = feed.take(value, now)
    if has_to:
        for monitor in monitors:
            monitor.feed(value, now)
        feed.note_fed()
    return has_to


def test_a_reading_concerns_nobody_while_all_monitors_wait() -> None:
    feed = Feed(start=0)
    monitor = Monitor(feed)

    assert fed(feed, monitor, value=1.0, now=10), "it is the first"
    assert not fed(feed, monitor, value=1.0, now=30)
    assert fed(feed, monitor, value=1.0, now=60), "the monitor is due"


def test_a_reading_beyond_what_is_harmless_concerns_monitors_at_once() -> None:
    feed = Feed(start=0)
    monitor = Monitor(feed)
    fed(feed, monitor, value=1.0, now=10)

    assert fed(feed, monitor, value=11.0, now=30)


def test_what_is_harmless_may_change() -> None:
    feed = Feed(start=0)
    monitor = Monitor(feed)
    fed(feed, monitor, value=1.0, now=10)
    monitor.harmless = GoodRange(highest=2.0)
    feed.note_harmless()

    assert fed(feed, monitor, value=3.0, now=30)


def test_once_one_monitor_was_judged_the_next_reading_is_new_to_it() -> None:
    feed = Feed(start=0)
    monitors = Monitor(feed), Monitor(feed)
    fed(feed, *monitors, value=1.0, now=10)
    monitors[1].judge()

    assert fed(feed, *monitors, value=1.0, now=30)


def test_every_reading_is_in_the_windows() -> None:
    feed = Feed(start=0)
    count = feed.windows.window(WindowSettings(statistic=Statistic.COUNT, length=100))
    monitor = Monitor(feed)
    for now in (110, 120, 130):
        fed(feed, monitor, value=1.0, now=now)

    assert count.value(130) == 3


def test_the_first_monitor_that_owes_says_until_when() -> None:
    feed = Feed(start=0)
    monitors = Monitor(feed), Monitor(feed)
    assert feed.owed_until() is None
    fed(feed, *monitors, value=1.0, now=10)
    monitors[0].owed_at = 30

    assert feed.owed_until() == 80
