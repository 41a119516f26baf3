"""The token, required for every request except on routes that need none."""

from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from api.http.access import Access, bearer_of
from api.http.gate.policies import RoutePolicies
from api.http.gate.refusals import Refusals, address_of, refuse
from api.http.problems import make_problem
from api.http.schemas.problem import Problem

_CHALLENGE = 'Bearer realm="pilothouse"'
_HINT = "send the header `Authorization: Bearer TOKEN` with the token of the service"


class TokenGate:
    """Passes on requests with the token.

    WebSockets always pass: a browser cannot set headers in the handshake, so the stream checks the
    token itself.
    """

    def __init__(
        self, app: ASGIApp, access: Access, policies: RoutePolicies, refusals: Refusals
    ) -> None:
        """Guard `app`.

        Args:
            app: What is behind the gate.
            access: The access control.
            policies: Which routes need no token; unknown paths need it.
            refusals: Counts rejected requests.
        """
        self._app = app
        self._access = access
        self._policies = policies
        self._refusals = refusals

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 401."""
        if scope["type"] != "http" or not self._access.required or self._is_open(scope):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        if self._access.accepts_header(headers):
            await self._app(scope, receive, send)
            return
        self._refusals.note(HTTPStatus.UNAUTHORIZED, address_of(scope))
        is_given = bearer_of(headers) is not None
        challenge = f'{_CHALLENGE}, error="invalid_token"' if is_given else _CHALLENGE
        problem = _problem(scope["path"], is_given=is_given)
        await refuse(problem, scope, receive, send, {"WWW-Authenticate": challenge})

    def _is_open(self, scope: Scope) -> bool:
        declared = self._policies.of(scope)
        return declared is not None and not declared.permission.needs_token


def _problem(path: str, *, is_given: bool) -> Problem:
    detail = "wrong token" if is_given else "a token is required"
    status = HTTPStatus.UNAUTHORIZED
    return make_problem(status, status.name, detail, path, more={"hint": _HINT})
