"""The example robot, for the tests of its interfaces: running behind HTTP, or not begun yet."""

from collections.abc import AsyncIterator

import pytest

from service.supervisor import Supervisor
from tests.support.http_robot import HttpRobot, http_robot
from tests.support.live_robot import make_supervisor
from tests.support.manual_clock import ManualClock


@pytest.fixture
async def robot() -> AsyncIterator[HttpRobot]:
    async with http_robot() as running:
        yield running


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def supervisor(clock: ManualClock) -> Supervisor:
    return make_supervisor(clock)
