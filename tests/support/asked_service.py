"""A service that answers the requests of commands from a table, and keeps what it was asked."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx
import pytest

from api.client.address import Address
from api.client.service_client import ServiceClient

Asked = tuple[str, str, Any]


class AskedService:
    """Answers `METHOD /path?query` with a body, a response or an error; all else with 404."""

    def __init__(self, answers: dict[str, Any] | None = None) -> None:
        self.answers: dict[str, Any] = answers or {}
        self.asked: list[Asked] = []

    @property
    def writes(self) -> list[Asked]:
        """Return what was asked of it besides reading."""
        return [asked for asked in self.asked if asked[0] != "GET"]

    def stand_in(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Answer all commands instead of a service on the network."""
        monkeypatch.setattr("api.client.service_client.service_at", self._at)

    def client(self) -> ServiceClient:
        """Return a client of this service."""
        return ServiceClient(Address.of("http://robot:8000"), httpx.MockTransport(self._answer))

    @contextmanager
    def _at(self, _: str) -> Iterator[ServiceClient]:
        yield self.client()

    def _answer(self, request: httpx.Request) -> httpx.Response:
        path = request.url.raw_path.decode()
        body = json.loads(request.content) if request.content else None
        self.asked.append((request.method, path, body))
        answer = self.answers.get(f"{request.method} {path}")
        if isinstance(answer, list):
            # One after the other; the last one stays.
            answer = answer.pop(0) if len(answer) > 1 else answer[0]
        if isinstance(answer, Exception):
            raise answer
        if isinstance(answer, httpx.Response):
            return answer
        if answer is None:
            code = "UNKNOWN_PART" if path.startswith(("/nodes", "/systems")) else "NOT_FOUND"
            return httpx.Response(404, json={"code": code, "detail": f"there is no {path}"})
        return httpx.Response(200, json=answer)
