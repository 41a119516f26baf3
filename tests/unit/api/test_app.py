"""The application as a whole: what holds for every resource."""

import asyncio
import importlib
import pkgutil
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from fastapi import APIRouter, FastAPI
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute, APIWebSocketRoute

from api.app import create_app
from api.http import routes
from tests.support.http_robot import HttpRobot
from tests.support.live_robot import make_supervisor

CONTRACT = {
    "/systems": {"get"},
    "/systems/{part}": {"get"},
    "/systems/{part}/state": {"get", "post"},
    "/systems/{part}/states": {"get"},
    "/systems/{part}/mode": {"get", "post"},
    "/systems/{part}/modes": {"get"},
    "/systems/{part}/why": {"get"},
    "/systems/{part}/errors": {"get"},
    "/systems/{part}/errors/{error}": {"post"},
    "/systems/{part}/errors/{error}/acknowledge": {"post"},
    "/systems/{part}/errors/{error}/shelf": {"put", "delete"},
    "/systems/{part}/reactions": {"get"},
    "/systems/{part}/reactions/{reaction}": {"patch"},
    "/systems/{part}/reactions/{reaction}/acknowledge": {"post"},
    "/nodes": {"get"},
    "/nodes/{part}": {"get"},
    "/nodes/{part}/state": {"get", "post"},
    "/nodes/{part}/states": {"get"},
    "/nodes/{part}/mode": {"get", "post"},
    "/nodes/{part}/modes": {"get"},
    "/nodes/{part}/why": {"get"},
    "/nodes/{part}/errors": {"get"},
    "/nodes/{part}/errors/{error}": {"post"},
    "/nodes/{part}/errors/{error}/acknowledge": {"post"},
    "/nodes/{part}/errors/{error}/shelf": {"put", "delete"},
    "/nodes/{part}/reactions": {"get"},
    "/nodes/{part}/reactions/{reaction}": {"patch"},
    "/nodes/{part}/reactions/{reaction}/acknowledge": {"post"},
    "/nodes/{part}/parameters": {"get", "patch"},
    "/nodes/{part}/checkpoints/{checkpoint}": {"post"},
    "/nodes/{part}/process": {"get", "post"},
    "/simulated": {"get"},
    "/simulated/nodes/{node}": {"patch"},
    "/simulated/vehicle": {"patch"},
    "/changes": {"get"},
    "/changes/{change}": {"get", "delete"},
    "/model": {"get"},
    "/model/check": {"post"},
    "/inference": {"post"},
    "/signals": {"get", "post"},
    "/signals/{signal}": {"get", "post"},
    "/signals/{signal}/history": {"get"},
    "/monitors": {"get"},
    "/system_state": {"get"},
    "/errors": {"get"},
    "/errors/{error}": {"post"},
    "/errors/{error}/acknowledge": {"post"},
    "/errors/{error}/shelf": {"put", "delete"},
    "/reactions": {"get"},
    "/analysis": {"get"},
    "/emergency_stop": {"get", "put"},
    "/devices": {"get"},
    "/devices/{part}/errors/{error}/acknowledge": {"post"},
    "/devices/{part}/errors/{error}/shelf": {"put", "delete"},
    "/mock": {"get"},
    "/mock/{signal}": {"patch"},
    "/tasks": {"get", "post"},
    "/tasks/preview": {"post"},
    "/tasks/current": {"get", "delete"},
    "/tasks/{task}": {"get"},
    "/tasks/{task}/waypoints": {"get"},
    "/holds": {"get"},
    "/holds/{owner}": {"put", "delete"},
    "/vehicle": {"get"},
    "/examples/tracks": {"get"},
    "/examples/tracks/{name}": {"get"},
    "/simulations": {"post"},
    "/events": {"get"},
    "/frames": {"get"},
    "/events/{event}/causes": {"get"},
    "/storage": {"get"},
    "/livez": {"get"},
    "/readyz": {"get"},
    "/healthz": {"get"},
    "/metrics": {"get"},
}
"""The contract of this release at the edge; later ones add to it."""


@pytest.fixture
def app() -> FastAPI:
    return create_app(make_supervisor(), allowed_hosts=[])


def test_everything_that_the_contract_names_is_there_and_nothing_else(app: FastAPI) -> None:
    paths = app.openapi()["paths"]

    assert {path: set(operations) for path, operations in paths.items()} == CONTRACT


@pytest.mark.parametrize("module", [found.name for found in pkgutil.iter_modules(routes.__path__)])
def test_no_handler_runs_in_a_thread(module: str) -> None:
    # The framework calls plain functions in a thread, where nothing of the robot may be touched.
    router: APIRouter = importlib.import_module(f"api.http.routes.{module}").router
    called = [
        call
        for route in router.routes
        if isinstance(route, APIRoute | APIWebSocketRoute)
        for call in calls(route.dependant)
    ]

    assert called
    assert [call for call in called if not asyncio.iscoroutinefunction(call)] == []


async def test_making_an_application_starts_no_task() -> None:
    before = asyncio.all_tasks()

    create_app(make_supervisor(), allowed_hosts=[])

    assert asyncio.all_tasks() == before


async def test_the_worker_is_there_as_long_as_the_application_is_served(
    robot: HttpRobot,
) -> None:
    async with robot.app.router.lifespan_context(robot.app):
        answer = await robot.http.post("/model/check", content="a: 1")

        assert answer.status_code == 200


async def test_nothing_of_what_is_answered_may_be_kept_by_a_browser(robot: HttpRobot) -> None:
    for path in ("/systems", "/nope", "/metrics"):
        assert (await robot.http.get(path)).headers["cache-control"] == "no-store"


async def test_a_browser_asks_again_whether_the_documents_it_keeps_are_the_newest(
    robot: HttpRobot,
) -> None:
    first = await robot.http.get("/openapi.json")
    again = await robot.http.get("/openapi.json", headers={"If-None-Match": first.headers["etag"]})

    assert first.headers["cache-control"] == "no-cache"
    assert (again.status_code, again.content) == (304, b"")


def calls(dependant: Dependant) -> Iterator[Callable[..., Any] | None]:
    """Yield a handler and everything that is called for it."""
    yield dependant.call
    for below in dependant.dependencies:
        yield from calls(below)
