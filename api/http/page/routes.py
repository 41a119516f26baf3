"""The routes of the page: `/`, its bundles by version, and its files as they are written.

Only files found at the start can be requested, so that no path can leave the package.
"""

from asyncio import to_thread
from functools import cache
from http import HTTPStatus
from pathlib import PurePosixPath

from fastapi import APIRouter, Request, Response
from starlette.exceptions import HTTPException

from api.http.page.assembled_page import assembled_page, written_files
from api.http.page.front_page import FirstFrames, FrontPage
from api.http.page.page_file import KEEP, MEDIA_TYPES, PageFile, answer_with
from api.http.route_policy import Permission, policy


def page_routes(first_frames: FirstFrames) -> APIRouter:
    """Return the routes of the page.

    Args:
        first_frames: What the page is to show before it is connected.
    """
    router = APIRouter(include_in_schema=False)
    # A robot in a simulation has these routes as well, and nobody asks for its page.
    front_page = cache(lambda: FrontPage(assembled_page()))

    @router.get("/")
    @policy(Permission.READ_PUBLIC)
    async def get_index(request: Request) -> Response:
        return await front_page().answer(request, first_frames)

    # A page of another version is to notice, and not to run with what it does not know.
    @router.get("/web/v/{version}/{name}")
    @policy(Permission.READ_PUBLIC)
    async def get_bundle(version: str, name: str, request: Request) -> Response:
        page = assembled_page()
        file = page.files.get(name) if version == page.version else None
        return answer_with(_there(file), request, KEEP)

    @router.get("/web/{path:path}")
    @policy(Permission.READ_PUBLIC)
    async def get_file(path: str, request: Request) -> Response:
        # The loop waits for no disk, nor for a path that is none.
        is_known = path in written_files()
        return answer_with(_there(await to_thread(_read, path) if is_known else None), request)

    return router


def _read(path: str) -> PageFile | None:
    """Return a file as it is written; None: it was removed since the start."""
    try:
        content = written_files()[path].read_bytes()
    except FileNotFoundError:
        return None
    return PageFile.of(content, MEDIA_TYPES[PurePosixPath(path).suffix])


def _there(file: PageFile | None) -> PageFile:
    if file is None:
        raise HTTPException(HTTPStatus.NOT_FOUND)
    return file
