"""A service that a task is submitted to, and its stream, as a test lays them out."""

import asyncio
import io
from collections.abc import Callable
from typing import Any

import httpx
import pytest

from api.cli import task_follower
from api.client.address import Address
from api.client.link import Listener
from api.client.outcomes import Json
from api.client.service_client import ServiceClient
from tests.support.monitor import URL, frame

PREVIEW: dict[str, Any] = {
    "waypoint_count": 2,
    "length_m": 799.52,
    "min_radius_m": 40.04,
    "vehicle_min_radius_m": 2.5,
    "steerable": True,
    "start": {"distance_m": 0.3, "heading_error_rad": -0.1},
    "approach": None,
    "duration_s": 289.4,
    "warnings": [],
}


class Terminal(io.StringIO):
    """A terminal that keeps what it shows."""

    def isatty(self) -> bool:
        """Say that it is one."""
        return True


def task(status: str = "RUNNING", distance_m: float = 0.0, **more: object) -> dict[str, Any]:
    """Return a task of 10 m."""
    return {
        "id": "t1",
        "status": status,
        "distance_m": distance_m,
        "length_m": 10.0,
        "progress": distance_m / 10,
        "cross_track_error_m": 0.02,
        "reason": None,
        **more,
    }


def shows(seen: Json | None, **more: object) -> Json:
    """Return a frame with this task."""
    return {**frame(task=seen), **more}


def problem(status: int, **more: object) -> httpx.Response:
    """Return a problem document."""
    body = {"status": status, "code": "REFUSED", "title": "Refused", "detail": "it is so", **more}
    return httpx.Response(status, json=body)


class Loss:
    """In a stream: the connection is lost, and not restored if nothing follows."""

    def __init__(self, why: str) -> None:
        self.why = why


Step = Json | Loss | Exception | Callable[[], None]


class Stream:
    """Stands in for the link: passes on what a test lays out, one connection after the other."""

    connections: list[list[Step]]
    """What each one says, in order."""
    topics: tuple[str, ...] = ()
    """Of the newest one."""

    @classmethod
    def stand_in(cls, monkeypatch: pytest.MonkeyPatch) -> None:
        """Replace the link as long as a test lasts."""
        monkeypatch.setattr(task_follower, "Link", cls)
        monkeypatch.setattr(cls, "connections", [], raising=False)

    def __init__(self, address: Address, listener: Listener, topics: tuple[str, ...]) -> None:
        assert address.url == URL
        self._listener = listener
        Stream.topics = topics

    async def run(self) -> None:
        """Say what is laid out for this connection, and wait for ever."""
        for step in Stream.connections.pop(0):
            if isinstance(step, Exception):
                raise step
            if isinstance(step, Loss):
                self._listener.lose(step.why)
            elif callable(step):
                step()
            else:
                self._listener.take(step)
        await asyncio.Event().wait()


class Service:
    """Answers requests with what a test lays out, and keeps what it was asked."""

    def __init__(self) -> None:
        self.asked: list[httpx.Request] = []
        self.preview = httpx.Response(200, json=PREVIEW)
        self.served = httpx.Response(201, json=task())
        self.current = problem(404)
        self.by_id: httpx.Response | Exception = httpx.Response(200, json=task("SUCCEEDED"))
        """The answer to `GET /tasks/t1`."""

    @property
    def client(self) -> ServiceClient:
        """Return what asks this service."""
        return ServiceClient(Address.of(URL), httpx.MockTransport(self._answer))

    @property
    def paths(self) -> list[str]:
        """Return the method and path of each request."""
        return [f"{request.method} {request.url.raw_path.decode()}" for request in self.asked]

    def _answer(self, request: httpx.Request) -> httpx.Response:
        self.asked.append(request)
        match request.method, request.url.path:
            case "POST", "/tasks/preview":
                return self.preview
            case "POST", "/tasks":
                return self.served
            case "GET", "/tasks/current":
                return self.current
            case "DELETE", "/tasks/current":
                return httpx.Response(204)
            case "GET", "/tasks/t1" if isinstance(self.by_id, httpx.Response):
                return self.by_id
        assert isinstance(self.by_id, Exception), request
        raise self.by_id
