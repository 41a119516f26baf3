"""HTTP request bodies within the limits of the service; larger ones are rejected early."""

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import Request, Response
from fastapi.routing import APIRoute

from api.http.body_parsing import BodyTooLargeError, parse_small, read_limited
from api.http.limits import ServiceLimits


def limits_of(request: Request) -> ServiceLimits:
    """Return the limits of the service."""
    limits: ServiceLimits = request.app.state.limits
    return limits


async def read_body(request: Request, limit: int) -> bytes:
    """Return the body; nothing is read if its Content-Length exceeds the limit.

    Args:
        request: The request.
        limit: Maximum length, bytes.

    Raises:
        BodyTooLargeError: It is longer.
    """
    if _announced_bytes(request) > limit:
        raise BodyTooLargeError(limit)
    return await read_limited(request.stream(), limit)


def _announced_bytes(request: Request) -> int:
    try:
        return int(request.headers.get("content-length", "0"))
    except ValueError:
        return 0


class JsonRoute(APIRoute):
    """A route that first reads its body, up to a limit, and parses it as strict JSON.

    The Content-Type is ignored, since `curl -d` declares its body as a form. `api.http.gate` has
    rejected requests of foreign pages before.
    """

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the framework's handler, called with a request whose body is read already."""
        handle = super().get_route_handler()
        if self.body_field is None:
            return handle

        async def handle_json(request: Request) -> Response:
            return await handle(await JsonRequest.read(request))

        return handle_json


class JsonRequest(Request):
    """A request with its body read and parsed."""

    _raw = b""
    _parsed: object = None

    @classmethod
    async def read(cls, request: Request) -> "JsonRequest":
        """Read and parse the body of a request.

        Raises:
            PilothouseError: It is too large, is not JSON or has too many members.
        """
        return cls.parse(request, await read_body(request, limits_of(request).json_bytes))

    @classmethod
    def parse(cls, request: Request, raw: bytes) -> "JsonRequest":
        """Return a request whose body was read already.

        Raises:
            PilothouseError: The body is not JSON or has too many members.
        """
        return cls.of(request, raw, parse_small(raw) if raw else None)

    @classmethod
    def of(cls, request: Request, raw: bytes, parsed: object) -> "JsonRequest":
        """Return a request with a given body."""
        headers = [item for item in request.scope["headers"] if item[0] != b"content-type"]
        headers.append((b"content-type", b"application/json"))
        read = cls({**request.scope, "headers": headers}, request.receive)
        read._raw, read._parsed = raw, parsed
        return read

    async def body(self) -> bytes:
        """Return the body as it was sent."""
        return self._raw

    async def json(self) -> object:
        """Return what the body says."""
        return self._parsed
