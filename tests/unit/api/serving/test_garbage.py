"""What a full garbage collection has looked at once is not looked at again."""

import gc
import weakref
from collections.abc import Iterator

import pytest

from api.serving.garbage import keep_survivors, settle_heap


class Thing:
    """Can refer to another, and be referred to weakly."""

    other: "Thing | None" = None


@pytest.fixture(autouse=True)
def _settled_heap() -> Iterator[None]:
    thresholds = gc.get_threshold()
    settle_heap()
    yield
    gc.callbacks.remove(keep_survivors)
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
