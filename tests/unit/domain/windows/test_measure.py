"""What a statistic does unless it says otherwise."""

from collections.abc import Sequence

from domain.timebase import Instant
from domain.windows.contents import Contents
from domain.windows.measure import Measure
from tests.support.windows import above


class _Newest(Measure):
    """A statistic that needs nothing but what it has to say."""

    def __init__(self) -> None:
        self._value = 0.0

    def enter(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        self._value = values[-1]

    def leave(self, times: Sequence[Instant], values: Sequence[float]) -> None:
        pass

    def value(self, contents: Contents, now: Instant) -> float:
        return self._value


def test_it_may_change_when_the_oldest_reading_leaves() -> None:
    contents = Contents(length=5, size=10, start=0)
    contents.extend([3, 4], [1.0, 2.0])

    assert _Newest().changes_at(contents, now=4) == 8
    assert _Newest().crosses_at(contents, 4, above(1.0), value=2.0) == 8


def test_without_a_reading_nothing_changes() -> None:
    empty = Contents(length=5, size=10, start=0)

    assert _Newest().changes_at(empty, now=4) is None
    assert _Newest().crosses_at(empty, 4, above(1.0), value=2.0) is None
