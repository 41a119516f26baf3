"""Whoever asked for a change can wait for its end, and all ends are counted."""

import asyncio
from collections.abc import AsyncIterator

import pytest

from domain.errors import UnknownChangeError
from domain.identifiers import ChangeId
from domain.inputs import ModeRequest
from domain.snapshot import ChangeStatus
from service.supervisor import Supervisor
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.models import ACTUATION, PERFORMANCE


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
async def supervisor(clock: ManualClock) -> AsyncIterator[Supervisor]:
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        yield supervisor


async def test_ended_changes_are_counted_by_how_they_ended(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE))
    supervisor.submit(ModeRequest(ACTUATION, "MODERATE"))
    await clock.advance(3)
    assert supervisor.change_ends.counts == {"superseded": 1, "succeeded": 1}


async def test_whoever_waits_for_a_change_is_told_its_end(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    change = supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE)).change
    assert change is not None
    waiting = asyncio.ensure_future(supervisor.change_ends.wait(change, 5))
    await clock.advance(2)
    assert waiting.done()
    assert (await waiting).status is ChangeStatus.SUCCEEDED


async def test_whoever_waits_too_short_gets_the_change_as_it_is(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    change = supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE)).change
    assert change is not None
    waiting = asyncio.ensure_future(supervisor.change_ends.wait(change, 0.1))
    await clock.advance(0.2)
    assert (await waiting).status is ChangeStatus.RUNNING


async def test_when_the_service_ends_nobody_waits_any_longer(
    clock: ManualClock, supervisor: Supervisor
) -> None:
    change = supervisor.submit(ModeRequest(ACTUATION, PERFORMANCE)).change
    assert change is not None
    waiting = asyncio.ensure_future(supervisor.change_ends.wait(change, 60))
    await clock.advance(0.1)
    supervisor.change_ends.stop()
    assert (await waiting).status is ChangeStatus.RUNNING
    assert (await supervisor.change_ends.wait(change, 60)).status is ChangeStatus.RUNNING


async def test_waiting_for_an_unknown_change_is_an_error(supervisor: Supervisor) -> None:
    with pytest.raises(UnknownChangeError):
        await supervisor.change_ends.wait(ChangeId("c9"), 1)
