"""What a full garbage collection has looked at once is not looked at again."""

import gc
import weakref
from collections.abc import Iterator

import pytest

from api.serving.garbage import Heap


class Thing:
    """Can refer to another, and be referred to weakly."""

    other: "Thing | None" = None


class Clock:
    now_s = 0.0


@pytest.fixture(autouse=True)
def clock() -> Iterator[Clock]:
    thresholds = gc.get_threshold()
    clock = Clock()
    heap = Heap(lambda: clock.now_s)
    heap.settle()
    yield clock
    gc.callbacks.remove(heap.follow)
    gc.set_threshold(*thresholds)
    gc.unfreeze()


def test_what_survives_a_full_collection_is_not_looked_at_again() -> None:
    things = [Thing() for _ in range(1_000)]

    gc.collect()

    looked_at = set(map(id, gc.get_objects()))
    assert not [thing for thing in things if id(thing) in looked_at]


def test_things_that_refer_to_each_other_are_still_collected() -> None:
    one, two = Thing(), Thing()
    one.other, two.other = two, one
    seen = weakref.ref(one)

    del one, two
    gc.collect()

    assert seen() is None


def test_what_is_frozen_is_released_by_its_reference_count() -> None:
    thing = Thing()
    seen = weakref.ref(thing)
    gc.collect()

    del thing

    assert seen() is None


def old_garbage(count: int) -> list[weakref.ref[Thing]]:
    """Return references to things that refer to each other, and were in use when frozen."""
    things = [Thing() for _ in range(count)]
    for thing in things:
        thing.other = thing
    gc.collect()
    return [weakref.ref(thing) for thing in things]


def test_when_what_is_frozen_has_grown_by_half_its_garbage_is_collected(clock: Clock) -> None:
    garbage = old_garbage(gc.get_freeze_count())

    gc.collect()
    assert garbage[0]() is not None
    clock.now_s += 600.0
    gc.collect()

    assert {seen() for seen in garbage} == {None}


def test_garbage_that_is_little_makes_no_collection_long(clock: Clock) -> None:
    garbage = old_garbage(100)

    clock.now_s += 600.0
    gc.collect()

    assert garbage[0]() is not None
