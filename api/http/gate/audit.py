"""Who wrote what, and how it was answered: one event for each request that changes something."""

import re
from collections.abc import Callable
from http import HTTPStatus

from pydantic import TypeAdapter, ValidationError
from starlette.datastructures import QueryParams
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.http.gate.refusals import address_of
from domain.inputs import WriteRecord

_WRITES = frozenset({"DELETE", "PATCH", "POST", "PUT"})

_UNCHANGING = frozenset({"/inference", "/model/check", "/simulations", "/tasks/preview"})
_READINGS = re.compile(r"/signals(/.*)?", re.DOTALL)
"""They may come a hundred times a second, and have events of their own when they matter."""
_PLANNED = re.compile(r"/(systems|nodes)/.+/(mode|state|parameters)", re.DOTALL)
"""What takes `dry_run`; elsewhere the word means nothing, and hides nothing."""

_MAX_PATH = 200
_FLAG = TypeAdapter(bool)


class Audit:
    """Record each write that reached a route, also one that the route refused."""

    def __init__(self, app: ASGIApp, record: Callable[[WriteRecord], object]) -> None:
        """Watch `app`.

        Args:
            app: What is behind.
            record: Takes what was written, before the answer is sent.
        """
        self._app = app
        self._record = record

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and note how it is answered."""
        if scope["type"] != "http" or not is_write(scope):
            await self._app(scope, receive, send)
            return

        async def send_and_record(message: Message) -> None:
            if message["type"] == "http.response.start" and _reached_a_route(scope, message):
                self._record(_record_of(scope, message["status"]))
            await send(message)

        await self._app(scope, receive, send_and_record)


def is_write(scope: Scope) -> bool:
    """Tell whether a request may change something, beside what it reports.

    Args:
        scope: Of an HTTP request.
    """
    path: str = scope["path"]
    if scope["method"] not in _WRITES or path in _UNCHANGING or _READINGS.fullmatch(path):
        return False
    return not (_PLANNED.fullmatch(path) and _is_dry_run(scope))


def _is_dry_run(scope: Scope) -> bool:
    """Tell whether the query says so, as the route reads it."""
    try:
        return _FLAG.validate_python(QueryParams(scope["query_string"]).get("dry_run"))
    except ValidationError:
        return False


def _reached_a_route(scope: Scope, message: Message) -> bool:
    """Tell so by what the router left behind; it does that also for a method that is not done."""
    return "endpoint" in scope and message["status"] != HTTPStatus.METHOD_NOT_ALLOWED


def _record_of(scope: Scope, status: int) -> WriteRecord:
    host = address_of(scope)
    client = scope.get("client")
    named = f"[{host}]" if ":" in host else host
    return WriteRecord(
        method=scope["method"],
        path=scope["path"][:_MAX_PATH],
        status=status,
        address=f"{named}:{client[1]}" if client else host,
        actor=f"http:{host}",
    )
