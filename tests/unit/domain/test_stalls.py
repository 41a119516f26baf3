"""Stalls of the service are told, and never in floods."""

import pytest

from domain.inputs import ServiceStall
from domain.outbox import Outbox
from domain.stalls import TOLD_EVERY, Stalls
from domain.timebase import Instant, seconds


class Told:
    """The concern, and what it tells."""

    def __init__(self) -> None:
        self._outbox = Outbox()
        self._stalls = Stalls(self._outbox)

    def stall(self, late_s: float, at: Instant) -> list[tuple[str, dict[str, object]]]:
        """Report a stall; return the events."""
        self._stalls.take_stall(ServiceStall(seconds(late_s)), at)
        return [(event.kind, dict(event.data)) for event in self._outbox.take().events]


@pytest.fixture
def told() -> Told:
    return Told()


def test_a_stall_is_told_at_once(told: Told) -> None:
    assert told.stall(1.5, 0) == [("service.stalled", {"late_s": 1.5})]


def test_of_stalls_that_follow_the_longest_is_told_once_that_may_be(told: Told) -> None:
    told.stall(0.3, 0)
    assert told.stall(2.0, 1) == []
    assert told.stall(0.4, TOLD_EVERY - 1) == []
    assert told.stall(0.5, TOLD_EVERY) == [("service.stalled", {"late_s": 2.0})]
    assert told.stall(0.5, 2 * TOLD_EVERY) == [("service.stalled", {"late_s": 0.5})]
