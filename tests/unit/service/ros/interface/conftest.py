from collections.abc import AsyncIterator

import pytest

from tests.support.ros_robot import RosRobot, running_ros_robot


@pytest.fixture
async def robot() -> AsyncIterator[RosRobot]:
    async with running_ros_robot() as robot:
        yield robot
