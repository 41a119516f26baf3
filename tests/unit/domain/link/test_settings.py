"""Times of the link."""

from domain.link.settings import LinkSettings
from domain.timebase import seconds


def test_devices_miss_five_beats_of_each_other_before_one_counts_as_lost() -> None:
    slowly = LinkSettings().slowly

    assert (slowly.beat, slowly.lost) == (seconds(0.5), seconds(2.5))


def test_devices_wait_for_each_other_at_least_as_long_as_for_the_supervisor() -> None:
    assert LinkSettings(lost=seconds(10)).slowly.lost == seconds(10)
