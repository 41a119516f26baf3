"""The audit: one event for each request that changes something, with client and status."""

from collections.abc import Callable

from pydantic import TypeAdapter, ValidationError
from starlette.datastructures import QueryParams
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.http.gate.policies import RoutePolicies
from api.http.gate.refusals import address_of
from api.http.route_policy import AuditClass
from domain.actor import Actor
from domain.inputs import WriteRecord

_MAX_PATH = 200
_FLAG = TypeAdapter(bool)


class Audit:
    """Records each write that reached a route, also if the route rejected it."""

    def __init__(
        self, app: ASGIApp, record: Callable[[WriteRecord], object], policies: RoutePolicies
    ) -> None:
        """Watch `app`.

        Args:
            app: The application behind this one.
            record: Takes the record before the answer is sent.
            policies: Which routes are recorded.
        """
        self._app = app
        self._record = record
        self._policies = policies

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and record the status of its answer."""
        if scope["type"] != "http" or not self._is_recorded(scope):
            await self._app(scope, receive, send)
            return

        async def send_and_record(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._record(_record_of(scope, message["status"]))
            await send(message)

        await self._app(scope, receive, send_and_record)

    def _is_recorded(self, scope: Scope) -> bool:
        """Tell whether a request is recorded."""
        declared = self._policies.of(scope)
        if declared is None or declared.audit is AuditClass.NEVER:
            return False
        return declared.audit is AuditClass.ALWAYS or not _is_dry_run(scope)


def _is_dry_run(scope: Scope) -> bool:
    """Tell whether the query has `dry_run=true`, parsed as the route does."""
    try:
        return _FLAG.validate_python(QueryParams(scope["query_string"]).get("dry_run"))
    except ValidationError:
        return False


def _record_of(scope: Scope, status: int) -> WriteRecord:
    host = address_of(scope)
    client = scope.get("client")
    named = f"[{host}]" if ":" in host else host
    return WriteRecord(
        method=scope["method"],
        path=scope["path"][:_MAX_PATH],
        status=status,
        address=f"{named}:{client[1]}" if client else host,
        actor=Actor(way="http", address=host),
    )
