"""The example robot behind its HTTP interface, for stories that use several resources."""

from collections.abc import AsyncIterator

import pytest

from tests.support.http_robot import HttpRobot, http_robot


@pytest.fixture
async def robot() -> AsyncIterator[HttpRobot]:
    async with http_robot() as running:
        yield running
