"""The interface of a supervisor that runs only where a test lets it."""

from collections.abc import AsyncIterator

import httpx
import pytest
from fastapi import FastAPI

from api.app import create_app
from service.supervisor import Supervisor


@pytest.fixture
def app(supervisor: Supervisor) -> FastAPI:
    return create_app(supervisor, allowed_hosts=[])


@pytest.fixture
async def http(app: FastAPI) -> AsyncIterator[httpx.AsyncClient]:
    transport = httpx.ASGITransport(app)
    async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client:
        yield client
