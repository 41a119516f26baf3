"""Answers every error before or in a route with a problem document."""

from http import HTTPStatus

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from starlette.exceptions import HTTPException as StarletteHTTPException

from api.http.body_parsing import INVALID_QUERY, BodyTooLargeError, InvalidBodyError, faults_of
from api.http.path_methods import allowed_methods
from api.http.problems import HttpError, make_problem, problem_of, problem_response
from domain.errors import PilothouseError
from service.clock import Clock
from service.worker import WorkerBusyError

_OUTSIDE = frozenset({"body", "query", "path", "header"})


def add_problem_handlers(app: FastAPI, clock: Clock) -> None:
    """Let `app` answer every error with its problem document."""

    async def on_our_error(request: Request, error: Exception) -> Response:
        if not isinstance(error, PilothouseError):
            raise error
        headers = {}
        if isinstance(error, WorkerBusyError):
            headers["Retry-After"] = str(error.retry_after_s)
        if isinstance(error, BodyTooLargeError):
            # The rest of the body is not read; otherwise it would be read as the next request.
            headers["Connection"] = "close"
        return problem_response(problem_of(error, clock, request.url.path), headers)

    async def on_invalid_request(request: Request, error: Exception) -> Response:
        if not isinstance(error, RequestValidationError):
            raise error
        found = error.errors()
        code = None if any(fault["loc"][0] == "body" for fault in found) else INVALID_QUERY
        invalid = InvalidBodyError(faults_of(found, _OUTSIDE), code, count=len(found))
        return await on_our_error(request, invalid)

    app.add_exception_handler(PilothouseError, on_our_error)
    app.add_exception_handler(RequestValidationError, on_invalid_request)
    app.add_exception_handler(StarletteHTTPException, _on_http_error)


async def _on_http_error(request: Request, error: Exception) -> Response:
    """Answer errors of the framework: unknown paths and methods that are not allowed."""
    if not isinstance(error, StarletteHTTPException):
        raise error
    status = HTTPStatus(error.status_code)
    headers = dict(error.headers or {})
    code, detail, more = status.name, str(error.detail), {}
    if isinstance(error, HttpError):
        code = error.code
        more = {"hint": error.hint} if error.hint else {}
    elif status is HTTPStatus.NOT_FOUND:
        code, detail = "UNKNOWN_PATH", f"there is nothing at {request.url.path}"
        more = {"hint": "see /openapi.json"}
    elif status is HTTPStatus.METHOD_NOT_ALLOWED:
        methods = allowed_methods(request)
        detail = f"{request.method} not allowed; allowed: {', '.join(methods)}"
        headers["Allow"] = ", ".join(methods)
    problem = make_problem(status, code, detail, request.url.path, more=more)
    return problem_response(problem, headers)
