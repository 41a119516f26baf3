"""The length of the target of a request: path and query."""

from http import HTTPStatus

from starlette.types import ASGIApp, Receive, Scope, Send

from api.http.gate.refusals import Refusals, address_of, refuse
from api.http.problems import make_problem

MAX_TARGET_BYTES = 8_192
"""As usual for web servers."""
MAX_PATH_BYTES = 4_096
"""Fewer, since each route is compared with the path, which takes time that grows with it."""
MAX_FIELDS = 100
"""Of a query; each takes longer than its few bytes."""

_SHOWN = 100


class TargetGate:
    """Rejects requests whose path and query are too long, before anything looks at them."""

    def __init__(self, app: ASGIApp, refusals: Refusals) -> None:
        """Guard `app`.

        Args:
            app: What is behind the gate.
            refusals: Counts rejected requests.
        """
        self._app = app
        self._refusals = refusals

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 414."""
        if scope["type"] == "lifespan" or _is_short(scope):
            await self._app(scope, receive, send)
            return
        status = HTTPStatus.REQUEST_URI_TOO_LONG
        self._refusals.note(status, address_of(scope))
        detail = (
            f"the path is longer than {MAX_PATH_BYTES} bytes, or path and query together are "
            f"longer than {MAX_TARGET_BYTES}, or the query has more than {MAX_FIELDS} fields"
        )
        problem = make_problem(status, "URI_TOO_LONG", detail, f"{scope['path'][:_SHOWN]}...")
        await refuse(problem, scope, receive, send)


def _is_short(scope: Scope) -> bool:
    """Tell whether the target is short, as it was sent: with its percent signs, where known."""
    path = len(scope.get("raw_path") or scope["path"].encode("utf-8", "surrogatepass"))
    query: bytes = scope.get("query_string", b"")
    has_few_fields = query.count(b"&") < MAX_FIELDS
    return path <= MAX_PATH_BYTES and path + len(query) <= MAX_TARGET_BYTES and has_few_fields
