"""Finds the policy of the route of a request, before the router runs."""

import re
from collections import defaultdict
from collections.abc import Sequence

from starlette.routing import BaseRoute, compile_path
from starlette.types import Scope

from api.http.route_policy import RoutePolicy, UndeclaredRouteError, policy_of
from api.http.route_table import each_route, first_name, methods_of

_KEY = "pilothouse.policy"
_WEBSOCKET = "WEBSOCKET"

_Routes = dict[tuple[str, str], list[tuple[re.Pattern[str], RoutePolicy]]]
"""By method and first segment of the path, in the order in which routes are tried."""


class RoutePolicies:
    """The policies of all routes, found by method and path as the router matches them."""

    def __init__(self, routes: Sequence[BaseRoute]) -> None:
        """Read the declarations.

        Args:
            routes: Of the whole application, in the order in which they are tried.

        Raises:
            UndeclaredRouteError: A route has no policy.
        """
        self._routes: _Routes = defaultdict(list)
        for route in each_route(routes):
            declared = policy_of(route.endpoint)
            if declared is None:
                raise UndeclaredRouteError(route.path)
            pattern, _, _ = compile_path(route.path)
            for method in methods_of(route) or (_WEBSOCKET,):
                self._routes[method, first_name(route.path)].append((pattern, declared))

    def of(self, scope: Scope) -> RoutePolicy | None:
        """Return the policy of the route of a request; None: there is no such route.

        HEAD has the policy of GET. The result is kept in the scope, for the next gate.

        Args:
            scope: Of an HTTP request or a WebSocket.
        """
        if _KEY not in scope:
            scope[_KEY] = self._find(scope)
        found: RoutePolicy | None = scope[_KEY]
        return found

    def _find(self, scope: Scope) -> RoutePolicy | None:
        method = scope.get("method", _WEBSOCKET)
        path: str = scope["path"]
        key = ("GET" if method == "HEAD" else method, first_name(path))
        candidates = self._routes.get(key, ())
        return next((declared for pattern, declared in candidates if pattern.match(path)), None)
