"""Which tier answers a question, and how much all of them take."""

from itertools import pairwise

import pytest

from domain.timebase import seconds
from service.storage.trends.tiers import MEMORY_TIERS, TIERS, pick_tier

NOW = seconds(1e9)
HOUR = seconds(3_600.0)
EVERYTHING = [0] * len(TIERS)


@pytest.mark.parametrize(
    ("span_s", "points", "width_s"),
    [
        (60, 1_000, 0),
        (1_000, 1_000, 0),
        (1_001, 1_000, 1),
        (4 * 3_600, 1_000, 1),
        (86_400, 1_000, 10),
        (7 * 86_400, 1_000, 60),
        (366 * 86_400, 1_000, 600),
        (86_400, 10_000, 1),
        (60, 2, 0),
        (86_400, 2, 10),
    ],
)
def test_the_longer_the_chart_the_coarser_the_tier(
    span_s: float, points: int, width_s: float
) -> None:
    tier = pick_tier(TIERS, EVERYTHING, NOW - seconds(span_s), NOW, points)

    assert TIERS[tier].width == seconds(width_s)


def test_a_tier_that_does_not_reach_back_is_left_out() -> None:
    oldest = [NOW - HOUR // 6, NOW - HOUR // 6, NOW - 2 * HOUR, NOW - 2 * HOUR, NOW - 2 * HOUR]

    assert pick_tier(TIERS, oldest, NOW - HOUR // 4, NOW, 1_000) == 2


def test_what_began_only_lately_is_shown_as_fine_as_it_is() -> None:
    oldest = [NOW - HOUR // 10] * len(TIERS)

    assert pick_tier(TIERS, oldest, NOW - HOUR // 4, NOW, 1_000) == 0


def test_a_fine_tier_that_has_nothing_is_no_answer() -> None:
    oldest = [None, None, NOW - HOUR, NOW - HOUR, NOW - HOUR]

    assert pick_tier(TIERS, oldest, NOW - HOUR // 4, NOW, 1_000) == 2


def test_of_tiers_that_all_begin_too_late_the_oldest_one_answers() -> None:
    oldest = [NOW - 1, NOW - 2, NOW - 3, NOW - 4, NOW - HOUR]

    assert pick_tier(TIERS[:4], oldest, NOW - 2 * HOUR, NOW, 10_000) == 3


def test_without_any_readings_there_is_a_tier_all_the_same() -> None:
    assert pick_tier(TIERS, [None] * len(TIERS), NOW - HOUR, NOW, 1_000) == 1


def test_each_tier_is_kept_longer_than_the_next_one_needs_to_make_a_block() -> None:
    for finer, coarser in pairwise(TIERS):
        assert finer.keep_for > 2 * coarser.block
        assert coarser.width % max(finer.width, 1) == 0


def test_all_tiers_together_are_bounded() -> None:
    assert sum(tier.keep_bytes for tier in TIERS) <= 720 * 1024 * 1024
    assert sum(tier.keep_bytes for tier in MEMORY_TIERS) <= 23 * 1024 * 1024
