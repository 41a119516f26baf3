"""The documents of the interface, and a page that shows them; nothing in them is of this robot.

The page is Swagger UI, as a package brings it, with a part of our own for the stream. Nothing is
loaded from elsewhere.
"""

from collections.abc import Mapping
from functools import cache
from http import HTTPStatus
from importlib.metadata import distribution
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType

from fastapi import APIRouter, FastAPI, Request, Response
from fastapi.responses import FileResponse, JSONResponse

from api.documents.asyncapi import stream_document
from api.http.gate.headers import CONTENT_SECURITY_POLICY
from api.http.page.page_file import PageFile, answer_with
from api.http.route_policy import Permission, policy

router = APIRouter(include_in_schema=False)
openapi_router = APIRouter(include_in_schema=False)
"""Also of a robot in a simulation, which has no page."""

# Swagger UI shows its arrows and marks as images inside its style sheet.
_POLICY = CONTENT_SECURITY_POLICY.replace("img-src 'self'", "img-src 'self' data:")

# Only its files are used: none of its code runs.
_PACKAGE = distribution("fastapi-swagger")
_HEADERS: Mapping[str, str] = MappingProxyType(
    {"ETag": f'"{_PACKAGE.version}"', "Cache-Control": "no-cache"}
)


@openapi_router.get("/openapi.json")
@policy(Permission.READ_PUBLIC)
async def get_openapi(request: Request) -> Response:
    """Return the description of requests and answers."""
    state = request.app.state
    # Making it takes 0.2 s: once, and not for each request.
    if not hasattr(state, "openapi_file"):
        keep_description(request.app, encode_description(request.app))
    return answer_with(state.openapi_file, request)


def encode_description(app: FastAPI) -> bytes:
    """Return the description of requests and answers as JSON."""
    return bytes(JSONResponse(app.openapi()).body)


def keep_description(app: FastAPI, encoded: bytes) -> None:
    """Answer with a description that was encoded before."""
    app.state.openapi_file = PageFile.of(encoded, "application/json", compressed=True)


@router.get("/docs")
@policy(Permission.READ_PUBLIC)
async def get_page() -> Response:
    """Return the page."""
    headers = {"Content-Security-Policy": _POLICY}
    return Response(_page(), headers=headers, media_type="text/html")


@router.get("/docs/swagger-ui-bundle.js")
@policy(Permission.READ_PUBLIC)
async def get_script(request: Request) -> Response:
    """Return the program of Swagger UI."""
    return _asset("swagger-ui-bundle.js", "text/javascript", request)


@router.get("/docs/swagger-ui.css")
@policy(Permission.READ_PUBLIC)
async def get_style(request: Request) -> Response:
    """Return the style sheet of Swagger UI."""
    return _asset("swagger-ui.css", "text/css", request)


@router.get("/asyncapi.json")
@policy(Permission.READ_PUBLIC)
async def get_asyncapi(request: Request) -> Response:
    """Return the description of the stream."""
    state = request.app.state
    if not hasattr(state, "asyncapi_file"):
        keep_stream_description(request.app, stream_document())
    return answer_with(state.asyncapi_file, request)


def keep_stream_description(app: FastAPI, encoded: bytes) -> None:
    """Answer with a description of the stream that was encoded before."""
    app.state.asyncapi_file = PageFile.of(encoded, "application/json", compressed=True)


@cache
def _page() -> bytes:
    return (files("web") / "docs" / "index.html").read_bytes()


def _asset(name: str, media_type: str, request: Request) -> Response:
    """Answer with a file of the package, read while it is sent; or 304 if the browser has it."""
    if request.headers.get("if-none-match") == _HEADERS["ETag"]:
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=dict(_HEADERS))
    path = Path(str(_PACKAGE.locate_file(f"fastapi_swagger/resources/{name}")))
    return FileResponse(path, headers=dict(_HEADERS), media_type=media_type)
