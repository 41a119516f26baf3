"""What a page of another site can make a browser send to this service."""

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
    """Refuse what a page of another site can make a browser send to this service.

    * A name in `Host` that is not ours: a foreign name that was made to resolve to our address (DNS
      rebinding), by which a foreign page would be of the same origin.
    * A write, or a WebSocket, with a foreign `Origin`.
    * A write from a page with a body of a type that browsers send without asking first (a form).
    """

    def __init__(self, app: ASGIApp, allowed_hosts: Iterable[str], refusals: Refusals) -> None:
        """Guard `app`.

        Args:
            app: What is behind the gate.
            allowed_hosts: Names and addresses in `Host`, without port, beside those of loopback.
            refusals: Counts who was refused.
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
        """Tell whether a name is one of ours, or the very address that the request came to.

        An address cannot be made to resolve to another one, so it opens no way to a foreign page.
        """
        address, _ = scope.get("server") or ("", None)
        return bool(host) and (host in self._hosts or host == _bare(address))

    def _find_fault(self, scope: Scope) -> Problem | None:
        headers = Headers(scope=scope)
        path = scope["path"]
        hosts = headers.getlist("host")
        if len(hosts) != 1 or not self._is_ours(_bare(hosts[0]), scope):
            named = hosts[0] if hosts else ""
            hint = "a further name is allowed with `pilothouse serve --allowed-host NAME`"
            return make_problem(
                HTTPStatus.FORBIDDEN,
                "HOST_NOT_ALLOWED",
                f"this service is not asked by the name {named!r}",
                path,
                more={"hint": hint},
            )
        origin = headers.get("origin")
        if origin is None or (scope["type"] == "http" and scope["method"] in _SAFE_METHODS):
            return None
        if not is_same_origin(origin, hosts[0]):
            detail = f"a page of {origin!r} may not do this"
            return make_problem(HTTPStatus.FORBIDDEN, "FOREIGN_ORIGIN", detail, path)
        if scope["type"] == "http" and _has_body(headers) and not _is_typed(headers):
            detail = "a page sends JSON, YAML or CSV, and says so"
            return make_problem(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "UNSUPPORTED_TYPE", detail, path)
        return None


def is_same_origin(origin: str, host: str) -> bool:
    """Tell whether a page of `origin` comes from the service that was asked as `host`.

    The scheme is that of the page: behind a proxy that speaks TLS, ours is another one.

    Args:
        origin: As in the header, `https://robot.example` or `null`.
        host: As in the header, `robot.example:8000`.
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
    """Return a host without its port, in one of its forms; empty if it is none."""
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
