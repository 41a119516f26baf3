"""The length of the target of a request: path and query."""

from http import HTTPStatus

from starlette.types import ASGIApp, Receive, Scope, Send

from api.http.gate.refusals import Refusals, address_of, refuse
from api.http.problems import make_problem

MAX_TARGET_BYTES = 8_192
"""As usual for web servers. Routing and hints take time that grows with the path."""

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
        if scope["type"] == "lifespan" or _target_bytes(scope) <= MAX_TARGET_BYTES:
            await self._app(scope, receive, send)
            return
        status = HTTPStatus.REQUEST_URI_TOO_LONG
        self._refusals.note(status, address_of(scope))
        detail = f"path and query are longer than {MAX_TARGET_BYTES} bytes"
        problem = make_problem(status, "URI_TOO_LONG", detail, f"{scope['path'][:_SHOWN]}...")
        await refuse(problem, scope, receive, send)


def _target_bytes(scope: Scope) -> int:
    """Return the length as it was sent: with its percent signs, where the server tells it."""
    path = scope.get("raw_path") or scope["path"].encode("utf-8", "surrogatepass")
    return len(path) + len(scope.get("query_string", b""))
