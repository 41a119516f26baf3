"""Protection against requests that pages of other sites make a browser send to this service."""

import re
from collections.abc import Iterable
from http import HTTPStatus

from starlette.datastructures import Headers
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from api.http.access import READS_ONLY, Access
from api.http.gate.origins import AllowedOrigins, is_same_origin
from api.http.gate.policies import RoutePolicies
from api.http.gate.refusals import Refusals, address_of, refuse
from api.http.problems import make_problem
from api.http.route_policy import Permission
from api.http.schemas.problem import Problem
from domain.errors import shortened

LOOPBACK_NAMES = ("localhost", "127.0.0.1", "[::1]")

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class OriginGate:
    """Reject requests that pages of other sites make a browser send to this service.

    * A `Host` that is not allowed: a foreign name may resolve to our address (DNS rebinding), which
      would make a foreign page same-origin.
    * A write, or a WebSocket, with a foreign `Origin`. Pages of allowed origins may read; to write,
      they need the token of the service.
    * What a page of another site asks for, where the browser says so (`Sec-Fetch-Site`). A link to
      the page or the documents works.
    * A write from a page with a body of a type that browsers send without a preflight (a form).
    * A header that decides about this and is there twice.
    """

    def __init__(
        self,
        app: ASGIApp,
        allowed_hosts: Iterable[str],
        refusals: Refusals,
        *,
        origins: AllowedOrigins | None = None,
        policies: RoutePolicies | None = None,
        access: Access | None = None,
    ) -> None:
        """Guard `app`.

        Args:
            app: The application behind the gate.
            allowed_hosts: Names and addresses allowed in `Host`, without port, besides loopback.
            refusals: Counts rejected requests.
            origins: Allowed besides that of the service; None: none.
            policies: Tell what writes, and what is public; None: no route is known.
            access: Whether there is a token; None: there is none.
        """
        self._app = app
        self._refusals = refusals
        self._hosts = {_bare(host) for host in (*LOOPBACK_NAMES, *allowed_hosts)}
        self._origins = origins or AllowedOrigins()
        self._policies = policies
        self._has_token = access is not None and access.required

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, answer a preflight, or answer 400, 403 or 415."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        problem = self._find_fault(scope, headers)
        if problem is not None:
            self._refusals.note(HTTPStatus(problem.status), address_of(scope))
            await refuse(problem, scope, receive, send)
        elif _is_preflight(scope, headers):
            status = HTTPStatus.NO_CONTENT
            await Response(status_code=status, headers=_PREFLIGHT)(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    def _is_ours(self, host: str, scope: Scope) -> bool:
        """Tell whether a host is allowed, or is the address that the request came to.

        An address does not resolve to another one, so it gives no access to a foreign page.
        """
        address, _ = scope.get("server") or ("", None)
        return bool(host) and (host in self._hosts or host == _bare(address))

    def _find_fault(self, scope: Scope, headers: Headers) -> Problem | None:
        path = scope["path"]
        hosts = headers.getlist("host")
        if len(hosts) != 1 or not self._is_ours(_bare(hosts[0]), scope):
            named = hosts[0] if hosts else ""
            detail = f"Host {shortened(named)!r} is not allowed"
            more = {"hint": _ALLOW_HOST}
            return make_problem(_FORBIDDEN, "HOST_NOT_ALLOWED", detail, path, more=more)
        for name in _ONCE:
            if len(headers.getlist(name)) > 1:
                detail = f"the header {name} is there more than once"
                return make_problem(HTTPStatus.BAD_REQUEST, "REPEATED_HEADER", detail, path)
        return self._find_foreign_page(scope, headers, hosts[0])

    def _find_foreign_page(self, scope: Scope, headers: Headers, host: str) -> Problem | None:
        path = scope["path"]
        origins = headers.getlist("origin")
        origin = origins[0] if len(origins) == 1 else ", ".join(origins)
        is_ours = is_same_origin(origin, host)
        if origin in self._origins and not is_ours:
            return self._find_write(scope, headers, origin)
        if _is_cross_site(headers) and not self._is_link(scope, headers):
            detail = "a page of another site asked for this"
            more = {"hint": _ALLOW}
            return make_problem(_FORBIDDEN, "FOREIGN_ORIGIN", detail, path, more=more)
        is_read = scope["type"] == "http" and scope["method"] in _SAFE_METHODS
        if not origins or (is_read and "," not in origin and not _is_preflight(scope, headers)):
            return None
        if not is_ours:
            detail = f"Origin {shortened(origin)!r} is not allowed"
            more = {"hint": _ALLOW}
            return make_problem(_FORBIDDEN, "FOREIGN_ORIGIN", detail, path, more=more)
        return _find_untyped(scope, headers)

    def _find_write(self, scope: Scope, headers: Headers, origin: str) -> Problem | None:
        """Reject what a page of an allowed origin may not do; it only reads without a token."""
        path = scope["path"]
        if scope["type"] == "websocket":
            scope[READS_ONLY] = not self._has_token
            return None
        if _is_preflight(scope, headers):
            return None
        declared = self._policies.of(scope) if self._policies is not None else None
        if declared is not None and declared.permission.writes and not self._has_token:
            detail = f"a page of {shortened(origin)} may only read: the service has no token"
            more = {"hint": _NEED_TOKEN}
            return make_problem(_FORBIDDEN, "FOREIGN_ORIGIN", detail, path, more=more)
        return _find_untyped(scope, headers)

    def _is_link(self, scope: Scope, headers: Headers) -> bool:
        """Tell whether a browser follows a link to the page or to a document."""
        if scope["type"] != "http" or scope["method"] not in ("GET", "HEAD"):
            return False
        declared = self._policies.of(scope) if self._policies is not None else None
        return (
            headers.get("sec-fetch-mode", "").lower() == "navigate"
            and headers.get("sec-fetch-dest", "document").lower() == "document"
            and declared is not None
            and declared.permission is Permission.READ_PUBLIC
        )


_FORBIDDEN = HTTPStatus.FORBIDDEN
_ALLOW_HOST = "allow it with `pilothouse serve --allowed-host NAME`"
_ALLOW = "allow a page of another origin with `pilothouse serve --allowed-origin ORIGIN`"
_NEED_TOKEN = "start the service with a token, PILOTHOUSE_TOKEN, and send it"
_ONCE = ("content-length", "content-type", "sec-fetch-site", "sec-fetch-mode", "sec-fetch-dest")
_PREFLIGHT = {
    "Access-Control-Allow-Methods": "DELETE, GET, HEAD, PATCH, POST, PUT",
    "Access-Control-Allow-Headers": "Accept, Authorization, Content-Type, If-None-Match",
    "Access-Control-Max-Age": "600",
    "Vary": "Origin, Access-Control-Request-Method, Access-Control-Request-Headers",
}


def _is_preflight(scope: Scope, headers: Headers) -> bool:
    """Tell whether a browser asks if it may send a request of a page of another origin."""
    return (
        scope["type"] == "http"
        and scope["method"] == "OPTIONS"
        and "origin" in headers
        and "access-control-request-method" in headers
    )


def _is_cross_site(headers: Headers) -> bool:
    return "cross-site" in headers.get("sec-fetch-site", "").lower()


def _find_untyped(scope: Scope, headers: Headers) -> Problem | None:
    """Reject a body that a form of any page could send."""
    if scope["type"] != "http" or scope["method"] in _SAFE_METHODS:
        return None
    if not _has_body(headers) or _is_typed(headers):
        return None
    status = HTTPStatus.UNSUPPORTED_MEDIA_TYPE
    detail = "a page must send JSON, YAML or CSV, with its Content-Type"
    return make_problem(status, "UNSUPPORTED_TYPE", detail, scope["path"])


_HOST = re.compile(r"(\[[0-9a-f:.]+\]|[^\s:/?#@\[\]\\]+)(?::[0-9]*)?")


def _bare(host: str) -> str:
    """Return a host without its port, normalized; empty if it is invalid."""
    if host.count(":") > 1 and not host.startswith("["):
        host = f"[{host}]"
    match = _HOST.fullmatch(host.strip().lower())
    return match[1].removesuffix(".") if match else ""


def _has_body(headers: Headers) -> bool:
    return "transfer-encoding" in headers or headers.get("content-length", "0") != "0"


_TYPES = frozenset(
    {"application/json", "application/yaml", "application/x-yaml", "text/yaml", "text/csv"}
)


def _is_typed(headers: Headers) -> bool:
    return headers.get("content-type", "").partition(";")[0].strip().lower() in _TYPES
