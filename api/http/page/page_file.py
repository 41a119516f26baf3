"""One file that is served from memory: its media type, its tag, and how long it may be kept."""

import gzip
import hashlib
from dataclasses import dataclass
from http import HTTPStatus

from fastapi import Request, Response

MEDIA_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
"""Files of other kinds are not served."""

ASK_AGAIN = "no-cache"
KEEP = "public, max-age=31536000, immutable"
"""For an address that has the version of the content in it."""

_LEVEL = 9


@dataclass(frozen=True, slots=True)
class PageFile:
    """A file with its tag."""

    stored: bytes
    """In the form in which it is kept in memory."""
    media_type: str
    etag: str
    """Weak, since it is the same for both forms of the content."""
    compressed: bool = False
    """Whether it is kept compressed: browsers take it so, and the few others wait a millisecond."""

    @classmethod
    def of(cls, content: bytes, media_type: str, *, compressed: bool = False) -> "PageFile":
        """Return a file with the tag of its content."""
        etag = f'W/"{hashlib.sha256(content).hexdigest()[:16]}"'
        # Without the time, so that the same content has the same bytes.
        stored = gzip.compress(content, _LEVEL, mtime=0) if compressed else content
        return cls(stored, media_type, etag, compressed)

    @property
    def content(self) -> bytes:
        """Return what is in the file."""
        return gzip.decompress(self.stored) if self.compressed else self.stored


def answer_with(file: PageFile, request: Request, cache_control: str = ASK_AGAIN) -> Response:
    """Answer with the file, or with 304 if the browser has it.

    Args:
        file: What is asked for.
        request: Tells what the browser has, and whether it can read gzip.
        cache_control: How long a browser may do without asking.
    """
    headers = {"ETag": file.etag, "Cache-Control": cache_control}
    if file.compressed:
        headers["Vary"] = "Accept-Encoding"
    known = [_opaque(tag) for tag in request.headers.get("if-none-match", "").split(",")]
    if _opaque(file.etag) in known:
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    if not file.compressed or not reads_gzip(request):
        return Response(file.content, headers=headers, media_type=file.media_type)
    headers["Content-Encoding"] = "gzip"
    return Response(file.stored, headers=headers, media_type=file.media_type)


def reads_gzip(request: Request) -> bool:
    """Tell whether the sender of a request accepts a compressed answer."""
    for offer in request.headers.get("accept-encoding", "").lower().split(","):
        coding, _, parameter = offer.replace(" ", "").partition(";")
        if coding == "gzip":
            return parameter not in ("q=0", "q=0.0", "q=0.00", "q=0.000")
    return False


def _opaque(tag: str) -> str:
    return tag.strip().removeprefix("W/")
