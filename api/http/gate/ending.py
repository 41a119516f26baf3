"""Requests that are cut off since the service ends."""

import asyncio
from http import HTTPStatus

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.http.problems import make_problem, problem_response
from service.worker import WorkerClosedError


class Ending:
    """Answers 503 to a request that the server cancels, which it does only at its end.

    Otherwise the server would take that for a fault of the application: 500, and a traceback in
    the log.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on; if it is cancelled, answer what was not answered yet."""
        has_begun = False

        async def send_and_note(message: Message) -> None:
            nonlocal has_begun
            has_begun = True
            await send(message)

        try:
            await self._app(scope, receive, send_and_note)
        except asyncio.CancelledError:
            # A WebSocket was closed by the server before.
            if scope["type"] == "http" and not has_begun:
                error = WorkerClosedError()
                status = HTTPStatus.SERVICE_UNAVAILABLE
                problem = make_problem(status, error.code, error.message, scope["path"])
                await problem_response(problem, {"Connection": "close"})(scope, receive, send)
