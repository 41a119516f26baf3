"""The routes of an application: which are there, and which a request may be for."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Any

from fastapi import routing
from starlette.routing import BaseRoute, Match
from starlette.types import Receive, Scope, Send

_KEY = "pilothouse.route"


class RouteTable(BaseRoute):
    """Routes of which a request is compared only with those whose path begins with the same name.

    A router compares it with all, one after the other, and FastAPI does so twice for each router
    that was included: with 92 routes that was a sixth of the time that a request takes.
    """

    def __init__(self, routes: Sequence[BaseRoute]) -> None:
        """Sort the routes.

        Args:
            routes: In the order in which they are tried; no path has a parameter as its first name.
        """
        self.routes = tuple(routes)
        self._by_name: dict[str, list[BaseRoute]] = defaultdict(list)
        for route in routes:
            for name in dict.fromkeys(first_name(one.path) for one in each_route([route])):
                self._by_name[name].append(route)

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """Tell whether a route is for a request, or one with another method (`PARTIAL`)."""
        partly: tuple[Match, Scope] = (Match.NONE, {})
        for route in self._by_name.get(first_name(scope["path"]), ()):
            match, found = route.matches(scope)
            if match is Match.FULL:
                return match, {**found, _KEY: route}
            if match is Match.PARTIAL and partly[0] is Match.NONE:
                partly = match, {**found, _KEY: route}
        return partly

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let the route that was found handle the request."""
        route: BaseRoute = scope[_KEY]
        await route.handle(scope, receive, send)


def first_name(path: str) -> str:
    """Return the first name in a path."""
    return path.split("/", 2)[1] if "/" in path else ""


def unfolded(routes: Sequence[BaseRoute]) -> list[BaseRoute]:
    """Return routes, and instead of each table those in it."""
    return [
        inner
        for route in routes
        for inner in (route.routes if isinstance(route, RouteTable) else (route,))
    ]


def each_route(routes: Sequence[BaseRoute]) -> Iterator[Any]:
    """Yield each route with its whole path, methods and endpoint, also those of included routers.

    FastAPI 0.115 copies the routes of an included router; later versions keep the router.
    """
    flattened = getattr(routing, "iter_route_contexts", iter)
    yield from flattened(unfolded(routes))


def methods_of(route: Any) -> frozenset[str]:  # noqa: ANN401
    """Return the methods of a route of `each_route`; none: it is one of WebSockets."""
    return frozenset(getattr(route, "methods", None) or ())
