"""The example robot behind its HTTP interface, for stories that use several resources."""

from collections.abc import AsyncIterator, Iterator

import pytest

from tests.support.blocking_service import BlockingService
from tests.support.http_robot import HttpRobot, http_robot


@pytest.fixture
async def robot() -> AsyncIterator[HttpRobot]:
    async with http_robot() as running:
        yield running


@pytest.fixture(scope="module")
def service() -> Iterator[BlockingService]:
    service = BlockingService()
    yield service
    service.close()
