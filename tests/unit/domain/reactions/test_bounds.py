"""How often something may happen, also over a restart."""

from domain.kept import Keeping, Kept, KeptBound
from domain.outbox import Outbox
from domain.reactions.bounds import Bounds
from domain.timebase import seconds


def _bounds(most: int = 2, outbox: Outbox | None = None) -> Bounds:
    return Bounds("rule", ("a", "b"), most, outbox or Outbox())


def _kept(outbox: Outbox) -> tuple[Kept, ...]:
    return tuple(keeping.value for keeping in outbox.take().kept if keeping.value is not None)


def test_it_may_happen_at_once_as_long_as_it_did_not_happen_too_often() -> None:
    bounds = _bounds()
    assert bounds.free_at("a", 5) == 5
    bounds.note("a", 5)
    assert bounds.free_at("a", 6) == 6


def test_thereafter_it_may_when_the_first_of_those_times_is_long_enough_ago() -> None:
    bounds = _bounds()
    bounds.note("a", seconds(5))
    bounds.note("a", seconds(8))
    assert bounds.free_at("a", seconds(9)) == seconds(65)
    assert bounds.free_at("a", seconds(70)) == seconds(70)
    assert bounds.free_at("b", seconds(9)) == seconds(9), "each counts for itself"


def test_only_the_last_times_count() -> None:
    bounds = _bounds()
    for at in (0, 60, 120):
        bounds.note("a", seconds(at))
    assert bounds.free_at("a", seconds(120)) == seconds(120)
    bounds.note("a", seconds(121))
    assert bounds.free_at("a", seconds(121)) == seconds(180)


def test_a_restart_makes_nothing_free_again() -> None:
    outbox = Outbox()
    earlier = _bounds(outbox=outbox)
    earlier.note("a", seconds(5))
    earlier.note("a", seconds(8))

    later = _bounds()
    later.restore(_kept(outbox), seconds(1000))
    assert later.free_at("a", seconds(1001)) == seconds(1057), "while it was down, no time passed"


def test_what_counts_no_more_is_not_kept_any_more() -> None:
    outbox = Outbox()
    bounds = _bounds(outbox=outbox)
    bounds.note("a", seconds(5))
    assert bounds.wake_at() == seconds(65)
    bounds.pass_time(seconds(65))
    assert bounds.wake_at() is None
    assert outbox.take().kept == (Keeping(KeptBound, "rule:a", None),)


def test_what_the_model_no_longer_has_is_forgotten() -> None:
    outbox = Outbox()
    _bounds(outbox=outbox).restore([KeptBound("rule", "gone", (0,))], 0)
    assert outbox.take().kept == (Keeping(KeptBound, "rule:gone", None),)
