"""The HTTP interface of a supervisor that does not run, for tests that are no coroutines."""

import asyncio
from collections.abc import Mapping
from typing import Any

import httpx

from api.app import close_workers, create_app
from tests.support.live_robot import make_supervisor


class BlockingService:
    """Answers each request before it returns."""

    def __init__(self) -> None:
        self._runner = asyncio.Runner()
        self._app = create_app(make_supervisor(), allowed_hosts=[])
        transport = httpx.ASGITransport(self._app)
        self._http = httpx.AsyncClient(transport=transport, base_url="http://localhost")

    def post(self, path: str, body: Mapping[str, Any]) -> httpx.Response:
        """Return the answer to a POST."""
        return self._runner.run(self._http.post(path, json=body, timeout=60))

    def close(self) -> None:
        """End client, workers and loop."""
        self._runner.run(self._http.aclose())
        self._runner.run(close_workers(self._app))
        self._runner.close()
