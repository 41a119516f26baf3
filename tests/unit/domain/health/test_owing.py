"""When readings have to be taken account of even if no others come."""

from domain.health.feed import Feed
from domain.health.good_range import GoodRange
from domain.health.owing import Owing
from domain.timebase import Instant


class Monitor:
    """It owes until an instant that the test sets."""

    harmless = GoodRange()
    owed_at: Instant | None = None

    def __init__(self, feed: Feed, owed_until: Instant | None = None) -> None:
        self.owed_until = owed_until
        feed.join(self)

    def feed(self, value: float, now: Instant) -> bool:
        return False


class Story:
    """Two signals: one with two monitors, and one with one."""

    def __init__(self) -> None:
        feeds = {"load": Feed(0), "heat": Feed(0)}
        self.mean, self.rate = Monitor(feeds["load"]), Monitor(feeds["load"])
        self.heat = Monitor(feeds["heat"])
        self.owing = Owing(feeds)


def test_at_first_nothing_is_owed() -> None:
    story = Story()
    assert story.owing.next() is None
    story.owing.note("load")
    assert story.owing.next() is None
    assert story.owing.due(100) is None


def test_the_earliest_of_all_monitors_counts() -> None:
    story = Story()
    story.mean.owed_until, story.rate.owed_until, story.heat.owed_until = 30, 20, 25
    story.owing.note("load")
    story.owing.note("heat")

    assert story.owing.next() == 20
    assert story.owing.due(19) is None
    assert story.owing.due(20) == "load"


def test_a_monitor_that_owes_earlier_than_what_was_noted_comes_first() -> None:
    story = Story()
    story.mean.owed_until, story.heat.owed_until = 30, 25
    story.owing.note("load")
    story.owing.note("heat")
    story.rate.owed_until = 20
    story.owing.note("load")

    assert story.owing.next() == 20


def test_what_is_put_off_or_settled_is_not_due_any_more() -> None:
    story = Story()
    story.mean.owed_until, story.heat.owed_until = 30, 25
    story.owing.note("load")
    story.owing.note("heat")
    story.heat.owed_until = 40
    assert story.owing.next() == 30
    story.mean.owed_until = None
    assert story.owing.next() == 40
    story.mean.owed_until = 35
    story.owing.note("load")
    assert story.owing.next() == 35


def test_each_signal_is_due_until_it_is_taken_account_of() -> None:
    story = Story()
    story.mean.owed_until = story.heat.owed_until = 20
    story.owing.note("load")
    story.owing.note("heat")

    assert story.owing.due(20) == "load"
    assert story.owing.due(20) == "load"
    story.mean.owed_until = None
    assert story.owing.due(20) == "heat"
    story.heat.owed_until = None
    assert story.owing.due(20) is None
