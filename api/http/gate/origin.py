"""Protection against requests that pages of other sites make a browser send to this service."""

import re
from collections.abc import Iterable
from http import HTTPStatus
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from api.http.gate.refusals import Refusals, address_of, refuse
from api.http.problems import make_problem
from api.http.schemas.problem import Problem

LOOPBACK_NAMES = ("localhost", "127.0.0.1", "[::1]")

_SAFE_METHODS = frozenset({"GET", "HEAD", "OPTIONS"})


class OriginGate:
    """Reject requests that pages of other sites make a browser send to this service.

    * A `Host` that is not allowed: a foreign name may resolve to our address (DNS rebinding), which
      would make a foreign page same-origin.
    * A write, or a WebSocket, with a foreign `Origin`.
    * A write from a page with a body of a type that browsers send without a preflight (a form).
    """

    def __init__(self, app: ASGIApp, allowed_hosts: Iterable[str], refusals: Refusals) -> None:
        """Guard `app`.

        Args:
            app: The application behind the gate.
            allowed_hosts: Names and addresses allowed in `Host`, without port, besides loopback.
            refusals: Counts rejected requests.
        """
        self._app = app
        self._refusals = refusals
        self._hosts = {_bare(host) for host in (*LOOPBACK_NAMES, *allowed_hosts)}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or answer 403 or 415."""
        if scope["type"] in ("http", "websocket"):
            problem = self._find_fault(scope)
            if problem is not None:
                self._refusals.note(HTTPStatus(problem.status), address_of(scope))
                await refuse(problem, scope, receive, send)
                return
        await self._app(scope, receive, send)

    def _is_ours(self, host: str, scope: Scope) -> bool:
        """Tell whether a host is allowed, or is the address that the request came to.

        An address does not resolve to another one, so it gives no access to a foreign page.
        """
        address, _ = scope.get("server") or ("", None)
        return bool(host) and (host in self._hosts or host == _bare(address))

    def _find_fault(self, scope: Scope) -> Problem | None:
        headers = Headers(scope=scope)
        path = scope["path"]
        hosts = headers.getlist("host")
        if len(hosts) != 1 or not self._is_ours(_bare(hosts[0]), scope):
            named = hosts[0] if hosts else ""
            hint = "allow it with `pilothouse serve --allowed-host NAME`"
            return make_problem(
                HTTPStatus.FORBIDDEN,
                "HOST_NOT_ALLOWED",
                f"Host {named!r} is not allowed",
                path,
                more={"hint": hint},
            )
        origin = headers.get("origin")
        if origin is None or (scope["type"] == "http" and scope["method"] in _SAFE_METHODS):
            return None
        if not is_same_origin(origin, hosts[0]):
            detail = f"Origin {origin!r} is not allowed"
            return make_problem(HTTPStatus.FORBIDDEN, "FOREIGN_ORIGIN", detail, path)
        if scope["type"] == "http" and _has_body(headers) and not _is_typed(headers):
            detail = "a page must send JSON, YAML or CSV, with its Content-Type"
            return make_problem(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "UNSUPPORTED_TYPE", detail, path)
        return None


def is_same_origin(origin: str, host: str) -> bool:
    """Tell whether a page of `origin` comes from the service at `host`.

    Schemes are not compared: behind a proxy with TLS, ours differs from that of the page.

    Args:
        origin: Value of the header, such as `https://robot.example` or `null`.
        host: Value of the header, such as `robot.example:8000`.
    """
    try:
        page = urlsplit(origin)
        asked = urlsplit(f"{page.scheme}://{host}")
        default = _DEFAULT_PORTS.get(page.scheme)
        if default is None or not page.hostname:
            return False
        return (page.hostname, page.port or default) == (asked.hostname, asked.port or default)
    except ValueError:
        return False


_DEFAULT_PORTS = {"http": 80, "https": 443}
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
