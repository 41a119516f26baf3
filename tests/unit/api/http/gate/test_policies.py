"""Every route says what it does, and the gates find what it says."""

import re

import pytest
from fastapi import APIRouter, FastAPI

from api.app import create_app
from api.http.gate.policies import RoutePolicies
from api.http.route_policy import (
    AuditClass,
    Permission,
    RoutePolicy,
    UndeclaredRouteError,
    policy,
    policy_of,
)
from api.http.route_table import each_route, methods_of
from tests.support.asgi import websocket_scope
from tests.support.http_robot import declared_policies, http_scope
from tests.support.live_robot import make_supervisor

OBSERVE = RoutePolicy(Permission.OBSERVE, AuditClass.NEVER)
OPERATE = RoutePolicy(Permission.OPERATE, AuditClass.ALWAYS)


@pytest.fixture(scope="module")
def app() -> FastAPI:
    return create_app(make_supervisor(), allowed_hosts=[])


def test_every_route_declares_what_it_does_also_those_of_websockets(app: FastAPI) -> None:
    routes = list(each_route(app.routes))

    assert {"/ws", "/rosbridge", "/openapi.json", "/", "/systems"} <= {r.path for r in routes}
    assert [route.path for route in routes if policy_of(route.endpoint) is None] == []


def test_each_is_found_by_its_method_and_path(app: FastAPI) -> None:
    policies = RoutePolicies(app.routes)
    for route in each_route(app.routes):
        path = re.sub(r"{\w+(:path)?}", "x", route.path)
        for method in methods_of(route):
            assert policies.of(http_scope(method, path)) == policy_of(route.endpoint), path


def test_no_route_has_a_parameter_where_the_gates_look_for_a_name(app: FastAPI) -> None:
    assert [r.path for r in each_route(app.routes) if r.path.startswith("/{")] == []


def test_what_a_get_asks_for_changes_nothing(app: FastAPI) -> None:
    declared = {
        policy_of(route.endpoint)
        for route in each_route(app.routes)
        if {"GET", "HEAD"} & methods_of(route)
    }

    assert {found.permission for found in declared if found} == {
        Permission.READ_PUBLIC,
        Permission.PROBE,
        Permission.OBSERVE,
    }


@pytest.mark.parametrize(
    ("method", "path", "permission"),
    [
        ("GET", "/tasks/current", Permission.OBSERVE),
        ("HEAD", "/livez", Permission.PROBE),
        ("DELETE", "/tasks/current", Permission.STOP),
        ("POST", "/nodes/left/arm/mode", Permission.OPERATE),
        ("PATCH", "/nodes/left/arm/parameters", Permission.OPERATE),
        ("POST", "/signals/estop", Permission.REPORT),
    ],
)
def test_the_route_is_the_one_that_the_router_takes(
    method: str, path: str, permission: Permission
) -> None:
    found = declared_policies().of(http_scope(method, path))

    assert found is not None
    assert found.permission is permission


@pytest.mark.parametrize(
    ("method", "path"),
    [("GET", "/nowhere"), ("POST", "/livez"), ("DELETE", "/tasks/t1"), ("PUT", "*"), ("GET", "")],
)
def test_where_there_is_no_route_nothing_is_declared(method: str, path: str) -> None:
    assert declared_policies().of(http_scope(method, path)) is None


def test_a_handshake_is_for_the_route_of_a_websocket() -> None:
    found = declared_policies().of({**websocket_scope({}), "path": "/ws"})

    assert found == OBSERVE
    assert declared_policies().of({**websocket_scope({}), "path": "/systems"}) is None


def test_of_two_routes_for_a_path_the_first_counts() -> None:
    router = APIRouter()

    @router.post("/things/all")
    @policy(Permission.OPERATE)
    async def do_all() -> None: ...

    @router.post("/things/{thing}")
    @policy(Permission.OBSERVE)
    async def do_one(thing: str) -> None: ...

    policies = RoutePolicies(router.routes)

    assert policies.of(http_scope("POST", "/things/all")) == OPERATE
    assert policies.of(http_scope("POST", "/things/1")) == OBSERVE


def test_a_route_that_declares_nothing_keeps_the_service_from_starting() -> None:
    router = APIRouter()

    @router.get("/things")
    async def list_things() -> None: ...

    with pytest.raises(UndeclaredRouteError, match="/things declares no policy"):
        RoutePolicies(router.routes)
