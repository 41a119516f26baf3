import pytest

from domain.timebase import Instant, seconds
from service.watchdog import hanging

NOW = seconds(100)
LONG_AGO = seconds(98)
IN_TIME = NOW - seconds(1) + 1


@pytest.mark.parametrize(
    ("core_due", "ticked_at", "published_at", "owing_since", "words"),
    [
        (None, None, None, None, "has not ticked yet"),
        (None, LONG_AGO, NOW, None, "last tick 2.00 s ago"),
        (None, NOW, LONG_AGO, None, "last frame 2.00 s ago"),
        (LONG_AGO, NOW, NOW, None, "a deadline of the core was missed by 2.00 s"),
        (None, NOW, NOW, LONG_AGO, "the stream has written nothing for 2.00 s"),
        (NOW + 1, NOW, NOW, NOW, None),
        (None, NOW, NOW, None, None),
        (IN_TIME, IN_TIME, IN_TIME, IN_TIME, None),
    ],
)
def test_each_of_loop_publishing_and_core_is_watched(
    core_due: Instant | None,
    ticked_at: Instant | None,
    published_at: Instant | None,
    owing_since: Instant | None,
    words: str | None,
) -> None:
    assert hanging(core_due, ticked_at, published_at, owing_since, NOW) == words
