"""The methods that the paths of requests have, for answers to those that they do not have."""

import re
from collections.abc import Iterator, Sequence
from http import HTTPStatus
from typing import TypeAlias

from fastapi import FastAPI, Request
from starlette.exceptions import HTTPException
from starlette.routing import BaseRoute, compile_path

from api.http.dependencies import known_of_kind
from api.http.route_table import each_route, methods_of
from domain.state_and_mode import part_name

_SHOWN = frozenset({"DELETE", "GET", "PATCH", "POST", "PUT"})

_Route: TypeAlias = tuple[re.Pattern[str], int, frozenset[str]]
"""Pattern of the path, how many of its segments are literal, and the methods."""


def allowed_methods(request: Request) -> list[str]:
    """Return the methods that the path of a request has, in the order of the alphabet.

    Of the routes that match it, those count that say most about it: /tasks/preview is not one of
    /tasks/{task}, and /nodes/base/errors/JAM is an error before it is the node base/errors/JAM.
    Where there is such a node, that can be read as well.
    """
    path: str = request.scope["path"]
    matching = [route for route in _routes_of(request.app) if route[0].match(path)]
    most = max((literals for _, literals, _ in matching), default=0)
    methods = {
        method for _, literals, found in matching if literals == most for method in found & _SHOWN
    }
    if _names_a_part(request):
        methods.add("GET")
    if "GET" in methods:
        methods.add("HEAD")
    return sorted(methods)


def require_allowed(request: Request) -> None:
    """Check that the path of a request has its method, for a route that matches whatever follows.

    Raises:
        HTTPException: 405, it has others only.
    """
    if request.method not in allowed_methods(request):
        raise HTTPException(HTTPStatus.METHOD_NOT_ALLOWED)


def _names_a_part(request: Request) -> bool:
    kind, _, name = request.scope["path"].removeprefix("/").partition("/")
    if kind not in ("systems", "nodes"):
        return False
    return part_name(name) in known_of_kind(request, request.app.state.supervisor)


def _routes_of(app: FastAPI) -> Sequence[_Route]:
    """Return what is known of the routes of an application, collected at the first question."""
    state = app.state
    if not hasattr(state, "path_methods"):
        state.path_methods = tuple(_collect(app.routes))
    found: Sequence[_Route] = state.path_methods
    return found


def _collect(routes: Sequence[BaseRoute]) -> Iterator[_Route]:
    for route in each_route(routes):
        pattern, _, _ = compile_path(route.path)
        literals = sum(not name.startswith("{") for name in route.path.split("/"))
        yield pattern, literals, methods_of(route)
