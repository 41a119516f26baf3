"""Garbage collections come between turns, and look at nothing again that they have looked at."""

import asyncio
import gc
import os
import platform
import weakref
from collections.abc import Iterator
from pathlib import Path

import pytest

from api.serving.garbage import Heap

BLOCKS, BLOCK_BYTES = 20_000, 2_000
"""Together 40 MB, of blocks that are too small to be given back one by one."""


class Thing:
    """Can refer to another, and be referred to weakly."""

    other: "Thing | None" = None


class Clock:
    now_s = 0.0


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture(autouse=True)
def heap(clock: Clock) -> Iterator[Heap]:
    thresholds = gc.get_threshold()
    heap = Heap(lambda: clock.now_s)
    heap.settle()
    yield heap
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


@pytest.fixture
def begun() -> Iterator[list[int]]:
    """The generations of the collections that began."""
    generations: list[int] = []

    def note(phase: str, info: dict[str, int]) -> None:
        if phase == "start":
            generations.append(info["generation"])

    gc.callbacks.append(note)
    yield generations
    gc.callbacks.remove(note)


async def a_tick(heap: Heap) -> None:
    """Let a tick pass, and what it leaves to the next turn."""
    heap.note_tick(0.05)
    await asyncio.sleep(0)


async def test_a_long_turn_is_not_made_longer_by_collections(heap: Heap, begun: list[int]) -> None:
    things = [Thing() for _ in range(10_000)]
    assert not begun

    heap.note_tick(0.05)
    assert not begun, "the tick goes on first"
    await asyncio.sleep(0)

    assert len(begun) == 1
    assert len(things) == 10_000


async def test_no_tick_collects_what_is_little(heap: Heap, begun: list[int]) -> None:
    gc.collect()
    begun.clear()

    things = [Thing() for _ in range(100)]
    await a_tick(heap)

    assert not begun
    assert len(things) == 100


async def test_older_objects_are_looked_at_less_often(heap: Heap, begun: list[int]) -> None:
    gc.collect()
    begun.clear()

    things: list[Thing] = []
    for _ in range(25):
        things += [Thing() for _ in range(1_000)]
        await a_tick(heap)

    assert begun.count(0) > begun.count(1) > begun.count(2) == 1


def test_python_collects_itself_where_no_tick_comes(begun: list[int]) -> None:
    things = [Thing() for _ in range(120_000)]

    assert begun
    assert len(things) == 120_000


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="other C libraries cannot do this")
def test_memory_that_starting_no_longer_uses_goes_back_to_the_system(heap: Heap) -> None:
    blocks = [bytes(BLOCK_BYTES) for _ in range(BLOCKS)]
    above_them = bytes(BLOCK_BYTES)
    del blocks
    before = resident_bytes()

    gc.callbacks.remove(heap.follow)
    heap.settle()

    assert before - resident_bytes() > 0.8 * BLOCKS * len(above_them)


def resident_bytes() -> int:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")
