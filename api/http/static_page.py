"""The files of the page, read once from the package `web` and served from memory.

Only files found at the start can be requested, so that no path can leave the package.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from http import HTTPStatus
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import PurePosixPath

from fastapi import APIRouter, Request, Response
from starlette.exceptions import HTTPException

from api.http.route_policy import Permission, policy

MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
"""Files of other kinds are not served."""

_INDEX = "index.html"


@dataclass(frozen=True, slots=True)
class PageFile:
    """One file of the page."""

    content: bytes
    media_type: str
    etag: str

    @classmethod
    def of(cls, content: bytes, media_type: str) -> "PageFile":
        """Return a file with the tag of its content."""
        return cls(content, media_type, f'"{hashlib.sha256(content).hexdigest()[:16]}"')


def page_routes() -> APIRouter:
    """Return the routes of the page: `/` and `/web/...`."""
    found = dict(_read_all(files("web"), ""))
    router = APIRouter(include_in_schema=False)

    @router.get("/")
    @policy(Permission.READ_PUBLIC)
    async def get_index(request: Request) -> Response:
        return answer_with(found.get(_INDEX), request)

    @router.get("/web/{path:path}")
    @policy(Permission.READ_PUBLIC)
    async def get_file(path: str, request: Request) -> Response:
        return answer_with(found.get(path), request)

    return router


def answer_with(file: PageFile | None, request: Request) -> Response:
    """Answer with the file, or with 304 if the browser has it; it asks again each time."""
    if file is None:
        raise HTTPException(HTTPStatus.NOT_FOUND)
    headers = {"ETag": file.etag, "Cache-Control": "no-cache"}
    known = request.headers.get("if-none-match", "")
    if file.etag in [tag.strip().removeprefix("W/") for tag in known.split(",")]:
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    return Response(file.content, headers=headers, media_type=file.media_type)


def _read_all(folder: Traversable, path: str) -> Iterator[tuple[str, PageFile]]:
    for entry in folder.iterdir():
        media_type = MEDIA_TYPES.get(PurePosixPath(entry.name).suffix)
        if entry.is_dir():
            yield from _read_all(entry, f"{path}{entry.name}/")
        elif media_type is not None:
            yield f"{path}{entry.name}", PageFile.of(entry.read_bytes(), media_type)
