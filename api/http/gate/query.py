"""The query of a write: only fields that its route knows, and each once.

What reads ignores others, as web services do. A write must not: `?dry-run=true` would carry out
what was only to be planned.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args, get_origin
from urllib.parse import parse_qsl

from fastapi.dependencies.models import Dependant
from starlette.routing import BaseRoute, compile_path
from starlette.types import ASGIApp, Receive, Scope, Send

from api.http.body_parsing import INVALID_QUERY, InvalidBodyError
from api.http.problems import problem_of, problem_response
from api.http.route_policy import Permission, policy_of
from api.http.route_table import each_route, methods_of
from api.http.schemas.problem import BodyFault
from api.http.stop_route import QUERY_FAULT, StopRoute
from domain.errors import UnknownNameError, shortened
from service.clock import Clock

_WRITES = frozenset({"DELETE", "PATCH", "POST", "PUT"})

_Fields = Mapping[str, bool]
"""Names of the fields of a query; whether they may be there several times, since they are lists."""


@dataclass(frozen=True, slots=True)
class _Known:
    """What a route takes."""

    fields: _Fields | None
    """None: any."""
    decides: bool
    """Whether the route refuses a query itself, once it knows whether its body asks for a stop."""


_Routes = Sequence[tuple[re.Pattern[str], Mapping[str, _Known]]]
"""Paths in the order in which they are tried, and by method what is known of writes to them."""


class QueryGate:
    """Answers 422 to a write whose query has a field that its route does not know, or one twice.

    What stops the robot passes whatever its query is: to refuse a stop for a field that nobody
    reads would be worse than to ignore that (decision 25). Where the body says whether it stops,
    the route decides.
    """

    def __init__(self, app: ASGIApp, clock: Clock) -> None:
        """Guard `app`.

        Args:
            app: What is behind the gate.
            clock: For the problem document.
        """
        self._app = app
        self._clock = clock
        self._routes: _Routes | None = None

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 422."""
        known = self._known(scope) if _is_write_with_query(scope) else None
        error = None if known is None else _find_fault(scope, known.fields)
        if error is not None and known is not None and known.decides:
            scope[QUERY_FAULT], error = error, None
        if error is None:
            await self._app(scope, receive, send)
            return
        problem = problem_of(error, self._clock, scope["path"])
        await problem_response(problem)(scope, receive, send)

    def _known(self, scope: Scope) -> _Known | None:
        """Return what the route of a request takes; None: no write that is to be checked."""
        if self._routes is None:
            # At the first write with a query: routes are included after the gates are made, and
            # most simulations, each with its own application, send none.
            self._routes = _writes_by_path(scope["app"].routes)
        path: str = scope["path"]
        writes = next((writes for pattern, writes in self._routes if pattern.match(path)), {})
        return writes.get(scope["method"])


def _find_fault(scope: Scope, known: _Fields | None) -> InvalidBodyError | None:
    if known is None:
        return None
    given = parse_qsl(scope["query_string"].decode("latin-1"), keep_blank_values=True)
    times = Counter(name for name, _ in given)
    unknown = [name for name in times if name not in known]
    repeated = [name for name, may_repeat in known.items() if times[name] > 1 and not may_repeat]
    faults = [_fault(name, "EXTRA_FORBIDDEN", "there is no such field") for name in unknown]
    faults += [_fault(name, "REPEATED", f"is there {times[name]} times") for name in repeated]
    if not faults:
        return None
    hint = "this request takes no query"
    if known:
        hint = UnknownNameError("field", (unknown or repeated)[0], tuple(known)).hint or hint
    return InvalidBodyError(faults, INVALID_QUERY, hint)


def _is_write_with_query(scope: Scope) -> bool:
    return scope["type"] == "http" and bool(scope["query_string"]) and scope["method"] in _WRITES


def _writes_by_path(routes: Iterable[BaseRoute]) -> _Routes:
    found: dict[str, dict[str, _Known]] = {}
    for route in each_route(list(routes)):
        decides = _decides(route)
        fields = None if not decides and _stops(route) else query_fields(route)
        writes = found.setdefault(route.path, {})
        for method in _WRITES & methods_of(route):
            writes.setdefault(method, _Known(fields, decides))
    return [(compile_path(path)[0], writes) for path, writes in found.items()]


def _decides(route: Any) -> bool:  # noqa: ANN401
    original = getattr(route, "original_route", route)
    return isinstance(original, StopRoute) and original.body_field is not None


def _stops(route: Any) -> bool:  # noqa: ANN401
    """Tell whether each request of a route makes the robot safer, such as the end of a task."""
    declared = policy_of(route.endpoint)
    return declared is not None and declared.permission is Permission.STOP


def query_fields(route: Any) -> _Fields:  # noqa: ANN401
    """Return the fields of the query that a route declares, also through its dependencies.

    Args:
        route: Of `each_route`.
    """
    return {} if getattr(route, "dependant", None) is None else dict(_declared(route.dependant))


def _declared(dependant: Dependant) -> Iterator[tuple[str, bool]]:
    for field in dependant.query_params:
        yield field.alias, _is_list(field.field_info.annotation)
    for inner in dependant.dependencies:
        yield from _declared(inner)


def _is_list(kind: object) -> bool:
    """Tell whether a type is that of a list, which may be left out (`list[str] | None`)."""
    return any(get_origin(one) is list for one in (kind, *get_args(kind)))


def _fault(name: str, code: str, about: str) -> BodyFault:
    return BodyFault(pointer="", code=code, message=f"query {shortened(name)}: {about}")
