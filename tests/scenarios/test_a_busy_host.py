"""A drive whose supervision does not run for a second, with real clocks and real loops."""

import asyncio
import time
from collections.abc import Callable

import pytest
import uvloop

from domain.inputs import TaskRequest
from domain.snapshot import TaskPhase
from domain.timebase import seconds
from service.clock import MonotonicClock
from service.supervisor import Supervisor
from tests.support.live_robot import make_live_robot, running
from tests.support.paths import straight
from tests.support.waiting import until

BLOCKED_S = 1.0
LOOPS = (asyncio.new_event_loop, uvloop.new_event_loop)


async def drive(supervisor: Supervisor) -> None:
    """Begin a task, and wait until the vehicle moves."""
    supervisor.submit(TaskRequest(straight(), 0, "stanley", 1.0))
    await until(lambda: supervisor.core.driving.vehicle.command.speed_mps > 0.2)


def told(supervisor: Supervisor, *kinds: str) -> list[str]:
    """Return which of these kinds of events there were."""
    return [e.kind for e in supervisor.events.oldest_first() if e.kind in kinds]


def block(seconds_long: float) -> None:
    """Keep the event loop from running, as a host does that is too busy."""
    time.sleep(seconds_long)


@pytest.mark.parametrize("new_loop", LOOPS, ids=["asyncio", "uvloop"])
def test_a_drive_outlives_a_second_in_which_nothing_runs(
    new_loop: Callable[[], asyncio.AbstractEventLoop],
) -> None:
    async def live() -> None:
        supervisor, _ = make_live_robot(MonotonicClock())
        async with running(supervisor):
            await drive(supervisor)
            distance = next(iter(supervisor.core.driving.tasks())).distance_m
            block(BLOCKED_S)
            await asyncio.sleep(1.0)
            task = next(iter(supervisor.core.driving.tasks()))
            assert (task.status, task.reason) == (TaskPhase.RUNNING, None)
            assert task.distance_m > distance
            assert told(supervisor, "hold.set", "error.raised", "task.pausing") == []
            assert told(supervisor, "service.stalled") == ["service.stalled"]

    with asyncio.Runner(loop_factory=new_loop) as runner:
        runner.run(live())


@pytest.mark.parametrize("new_loop", LOOPS, ids=["asyncio", "uvloop"])
def test_a_pose_that_is_lost_during_that_second_still_holds_the_task(
    new_loop: Callable[[], asyncio.AbstractEventLoop],
) -> None:
    async def live() -> None:
        clock = MonotonicClock()
        supervisor, backend = make_live_robot(clock)
        async with running(supervisor):
            await drive(supervisor)
            backend.set_vehicle_fault("silent")
            await asyncio.sleep(0.1)
            block(BLOCKED_S)
            await clock.sleep_until(clock.now() + seconds(0.5))
            assert "vehicle" in supervisor.core.driving.holds
            assert supervisor.core.driving.vehicle.command.speed_mps == 0.0

    with asyncio.Runner(loop_factory=new_loop) as runner:
        runner.run(live())
