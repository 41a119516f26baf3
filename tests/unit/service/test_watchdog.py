import pytest

from domain.timebase import Instant, seconds
from service.watchdog import hanging

NOW = seconds(100)
LONG_AGO = seconds(98)


@pytest.mark.parametrize(
    ("core_due", "ticked_at", "published_at", "words"),
    [
        (None, None, None, "has not ticked yet"),
        (None, LONG_AGO, NOW, "last tick 2.00 s ago"),
        (None, NOW, LONG_AGO, "last frame 2.00 s ago"),
        (LONG_AGO, NOW, NOW, "a deadline of the core was missed by 2.00 s"),
        (NOW + 1, NOW, NOW, None),
        (None, NOW, NOW, None),
        (NOW - seconds(1) + 1, NOW - seconds(1) + 1, NOW - seconds(1) + 1, None),
    ],
)
def test_each_of_loop_publishing_and_core_is_watched(
    core_due: Instant | None,
    ticked_at: Instant | None,
    published_at: Instant | None,
    words: str | None,
) -> None:
    assert hanging(core_due, ticked_at, published_at, NOW) == words
