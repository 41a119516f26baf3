"""The old generation is collected while the vehicle stands, and not by Python in between."""

import asyncio
import gc
from collections.abc import AsyncIterator, Iterator

import pytest

from domain.inputs import TaskRequest
from domain.snapshot import SystemState
from service.garbage import COLLECT_AFTER, COLLECT_IN_ANY_CASE, collect_at_rest, settle_heap
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.paths import straight


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    before = gc.get_threshold()
    yield
    gc.set_threshold(*before)
    gc.unfreeze()


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        await clock.advance(2)
        yield supervisor


async def collections(
    monkeypatch: pytest.MonkeyPatch, supervisor: Supervisor, clock: ManualClock, grown: int
) -> int:
    """Return how often the old generation is collected within a minute and a half."""
    found: list[None] = []
    monkeypatch.setattr(gc, "get_count", lambda: (0, 0, grown))
    monkeypatch.setattr(gc, "collect", lambda: found.append(None))
    collecting = asyncio.create_task(collect_at_rest(supervisor.core, clock))
    await clock.advance(90)
    collecting.cancel()
    return len(found)


def test_python_itself_leaves_the_old_generation_alone() -> None:
    settle_heap()
    assert gc.get_freeze_count() > 0
    before = gc.get_stats()[2]["collections"]
    kept = [[number] for number in range(1_000_000)]
    assert gc.get_stats()[2]["collections"] == before
    assert len(kept) == 1_000_000


async def test_a_robot_at_rest_collects_what_has_grown(
    monkeypatch: pytest.MonkeyPatch, supervisor: Supervisor, clock: ManualClock
) -> None:
    assert await collections(monkeypatch, supervisor, clock, COLLECT_AFTER) == 1


async def test_little_is_not_worth_it(
    monkeypatch: pytest.MonkeyPatch, supervisor: Supervisor, clock: ManualClock
) -> None:
    assert await collections(monkeypatch, supervisor, clock, COLLECT_AFTER - 1) == 0


@pytest.mark.parametrize(("grown", "times"), [(COLLECT_AFTER, 0), (COLLECT_IN_ANY_CASE, 1)])
async def test_a_robot_that_drives_waits_as_long_as_memory_allows(
    monkeypatch: pytest.MonkeyPatch,
    supervisor: Supervisor,
    clock: ManualClock,
    grown: int,
    times: int,
) -> None:
    supervisor.submit(TaskRequest(straight(1_000), 0, "pure_pursuit", 2.0))
    await clock.advance(1)
    assert supervisor.core.system_state().state is SystemState.RUNNING
    assert await collections(monkeypatch, supervisor, clock, grown) == times
