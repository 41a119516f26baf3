"""Ids without an event are told, and as those of the run that lost them."""

from collections.abc import Sequence
from datetime import UTC, datetime, timedelta

from service.event_log import EventLog, Gap
from service.history.event_gaps import KnownGaps, with_gaps
from service.storage.journal import EventQuery, StoredEvent

NOON = datetime(2026, 5, 4, 12, tzinfo=UTC)


def stored(number: int, epoch: str) -> StoredEvent:
    """Return an event that happened as many seconds after noon as its id says."""
    at = NOON + timedelta(seconds=number)
    return StoredEvent(number, 1, epoch, 0, at, "hold.set", None, "", {}, "a hold", True)


KEPT = (stored(3, "one"), stored(4, "one"), stored(11, "two"))
"""The first two were dropped; the first run told up to 10, and lost 5 to 10."""


async def read(query: EventQuery) -> Sequence[StoredEvent]:
    return [event for event in KEPT if event.id > (query.after or 0)][: query.limit]


def known_gaps() -> KnownGaps:
    return KnownGaps(EventLog(epoch="two", before=10, earlier={"one": 4}), read)


def test_what_is_missing_in_a_range_is_told_where_it_is() -> None:
    told = list(with_gaps(KEPT, 1, 12, "one", "two"))

    assert told == [Gap(1, 2, "one"), *KEPT[:2], Gap(5, 10, "one"), KEPT[2], Gap(12, 12, "two")]


def test_a_range_that_is_whole_has_no_gap() -> None:
    assert list(with_gaps(KEPT[:2], 3, 4, "one", "two")) == list(KEPT[:2])


async def test_the_oldest_event_is_that_of_the_journal() -> None:
    assert await known_gaps().oldest(fresh=True) == 3


async def test_what_was_dropped_and_what_was_lost_is_told() -> None:
    gaps = await known_gaps().within(1, 11, 3, EventQuery())

    assert gaps == [Gap(1, 2, "one"), Gap(5, 10, "one")]


async def test_a_gap_outside_the_time_that_is_asked_for_is_not_told() -> None:
    after_all = EventQuery(from_at=NOON + timedelta(seconds=30))
    before_the_loss = EventQuery(to_at=NOON + timedelta(seconds=3))

    gaps = known_gaps()
    oldest = await gaps.oldest(fresh=True)

    assert await gaps.within(1, 11, oldest, after_all) == []
    assert await gaps.within(1, 11, oldest, before_the_loss) == [Gap(1, 2, "one")]


async def test_a_gap_is_told_only_as_far_as_the_range_goes() -> None:
    assert await known_gaps().within(6, 8, 3, EventQuery()) == [Gap(6, 8, "one")]
