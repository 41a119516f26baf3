from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from tests.support.recorded_robot import RecordedRobot
from tests.support.stored_robot import held_on_its_way, store
from tests.support.viewer import Viewer, viewing


@pytest.fixture(scope="session")
def robot() -> RecordedRobot:
    return held_on_its_way()


@pytest.fixture(scope="session")
def recorded(robot: RecordedRobot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of data of a robot."""
    folder = tmp_path_factory.mktemp("data") / "robot"
    store(folder, robot, checkpoints=(20,))
    return folder


@pytest.fixture
async def viewer(recorded: Path) -> AsyncIterator[Viewer]:
    async with viewing(recorded) as viewer:
        yield viewer
