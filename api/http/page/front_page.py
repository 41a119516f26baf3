"""The page itself, with the first frame of the robot in it, so that it draws before it connects."""

import asyncio
import time
import zlib
from collections.abc import Awaitable, Callable, Iterator
from typing import TypeAlias

from fastapi import Request, Response

from api.http.page.assembled_page import AssembledPage
from api.http.page.page_file import MEDIA_TYPES, PageFile, answer_with, reads_gzip

FirstFrames: TypeAlias = Callable[[], Awaitable[str | None]]
"""Returns what a client of the stream is sent first, as a JSON array; None: the page must not tell
it, or there is nothing yet."""

_HTML = MEDIA_TYPES[".html"]
_GZIP = 31
"""`wbits` of zlib for the gzip format."""
_LEVEL = 5
"""Of what is compressed for one answer: 9 takes twice as long for 5 % less."""
_SLICE = 32_768
"""Characters that are compressed in one turn of the event loop, in about 0.5 ms."""
_REST = 10
"""An answer is reused for so many times the time that it took to compress. Who asks again and again
for the page of a large robot thus never takes more than a tenth of a core."""


class FrontPage:
    """Answers `/`."""

    def __init__(self, page: AssembledPage) -> None:
        self._page = page
        self._bare = PageFile.of((page.head + page.foot).encode(), _HTML, compressed=True)
        self._compressing = asyncio.Lock()
        self._kept = b""
        self._kept_until = 0.0

    async def answer(self, request: Request, first_frames: FirstFrames) -> Response:
        """Answer with the page; only without a first frame may a browser keep it."""
        is_compressed = reads_gzip(request)
        async with self._compressing:
            if is_compressed and time.monotonic() < self._kept_until:
                return self._answer(self._kept, "gzip")
            frames = await first_frames()
            if frames is None:
                return answer_with(self._bare, request)
            text = f"{self._page.head}{_block(frames)}{self._page.foot}"
            if not is_compressed:
                return self._answer(text.encode())
            self._kept, took = await _compress(text)
            self._kept_until = time.monotonic() + took * _REST
            return self._answer(self._kept, "gzip")

    def _answer(self, content: bytes, coding: str | None = None) -> Response:
        headers = {"Cache-Control": "no-store", "Vary": "Accept-Encoding"}
        if coding:
            headers["Content-Encoding"] = coding
        return Response(content, headers=headers, media_type=_HTML)


def _block(frames: str) -> str:
    """Return frames as a block of data; nothing in them can end it."""
    safe = frames.replace("<", "\\u003c")
    return f'<script type="application/json" id="first-frame">{safe}</script>\n'


async def _compress(text: str) -> tuple[bytes, float]:
    """Return a text compressed, and how long that took, s; other tasks run in between."""
    packer = zlib.compressobj(_LEVEL, wbits=_GZIP)
    packed = []
    took = 0.0
    for piece in _slices(text):
        begin = time.perf_counter()
        packed.append(packer.compress(piece.encode()))
        took += time.perf_counter() - begin
        await asyncio.sleep(0)
    return b"".join([*packed, packer.flush()]), took


def _slices(text: str) -> Iterator[str]:
    return (text[start : start + _SLICE] for start in range(0, len(text), _SLICE))
