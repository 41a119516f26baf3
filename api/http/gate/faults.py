"""Unexpected exceptions."""

import logging
from http import HTTPStatus

from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.http.gate.refusals import address_of
from api.http.problems import make_problem, problem_response

log = logging.getLogger(__name__)


class UnexpectedErrors:
    """The edge of the service: logs unexpected exceptions, and answers without details."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer 500 if the application raises."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        has_begun = False

        async def send_and_note(message: Message) -> None:
            nonlocal has_begun
            has_begun = True
            await send(message)

        try:
            await self._app(scope, receive, send_and_note)
        except ClientDisconnect:
            log.info("%s went before it was answered", address_of(scope))
        except Exception:
            log.exception("%s %s failed", scope["method"], scope["path"])
            if has_begun:
                raise
            status = HTTPStatus.INTERNAL_SERVER_ERROR
            detail = "this is a bug in Pilothouse; see its log"
            problem = make_problem(status, "INTERNAL", detail, scope["path"])
            await problem_response(problem)(scope, receive, send)
