"""What was packed in one tier waits in the next one."""

from domain.timebase import seconds
from service.storage.trends.cascade import Cascade
from service.storage.trends.rows import RowsBySignal
from tests.support.trend_readings import SMALL_TIERS, readings


class _Blocks:
    """Remembers what was written; can fail."""

    def __init__(self) -> None:
        self.written: list[tuple[int, RowsBySignal]] = []
        self.works = True

    def write(self, tier: int, rows: RowsBySignal) -> bool:
        if self.works:
            self.written.append((tier, rows))
        return self.works


def test_readings_are_written_at_once_and_seconds_when_there_are_enough() -> None:
    cascade, blocks = Cascade(SMALL_TIERS), _Blocks()

    for second in range(4):
        cascade.add({0: readings([1.0] * 20, seconds(second))}, seconds(second))
        cascade.settle(blocks.write, seconds(second))

    tiers = [tier for tier, _ in blocks.written]
    assert tiers == [0, 0, 0, 0, 1]
    assert blocks.written[-1][1][0].count.tolist() == [20, 20, 20, 20]


def test_what_waits_is_what_no_block_has() -> None:
    cascade, blocks = Cascade(SMALL_TIERS), _Blocks()
    cascade.add({0: readings([1.0] * 20)}, 0)
    cascade.settle(blocks.write, 0)
    cascade.add({1: readings([5.0])}, 0)

    assert [len(rows) for rows in cascade.rows_of(0, 1)] == [1]
    assert sum(map(len, cascade.rows_of(0, 0))) == 0
    assert sum(map(len, cascade.rows_of(1, 0))) == 1
    assert cascade.oldest(1, 1) == readings([5.0]).first[0]
    assert cascade.oldest(0, 0) is None


def test_what_cannot_be_written_is_tried_again() -> None:
    cascade, blocks = Cascade(SMALL_TIERS[1:]), _Blocks()
    cascade.add({0: readings([7.0])}, 0)
    blocks.works = False
    cascade.settle(blocks.write, seconds(3.0))
    blocks.works = True

    cascade.settle(blocks.write, seconds(4.0))

    assert [rows[0].high.tolist() for _, rows in blocks.written] == [[7.0]]
    assert cascade.dropped == 0


def test_what_cannot_be_written_for_long_is_dropped_and_the_next_tier_has_it() -> None:
    cascade, blocks = Cascade(SMALL_TIERS[1:]), _Blocks()
    blocks.works = False
    cascade.add({0: readings([7.0] * 20)}, 0)

    for second in range(14):
        cascade.settle(blocks.write, seconds(second))

    assert cascade.dropped == 1
    assert sum(map(len, cascade.rows_of(0, 0))) == 0
    assert [rows.high.tolist() for rows in cascade.rows_of(1, 0)] == [[7.0]]


def test_at_the_end_the_readings_are_written_whatever_the_time() -> None:
    cascade, blocks = Cascade(SMALL_TIERS), _Blocks()
    cascade.add({0: readings([7.0])}, 0)

    cascade.finish(blocks.write)
    cascade.finish(blocks.write)

    assert [tier for tier, _ in blocks.written] == [0]


def test_what_a_finer_tier_has_lost_is_written_as_soon_as_the_disk_works() -> None:
    cascade, blocks = Cascade(SMALL_TIERS), _Blocks()
    blocks.works = False
    cascade.add({0: readings([7.0] * 20)}, 0)
    for second in range(14):
        cascade.settle(blocks.write, seconds(second))
    blocks.works = True

    cascade.add({0: readings([1.0], seconds(14.0))}, seconds(14.0))
    cascade.settle(blocks.write, seconds(14.0))

    assert [tier for tier, _ in blocks.written] == [0, 1, 2, 3]
    assert max(blocks.written[-1][1][0].high) == 7.0
