"""Bodies as they come over HTTP: within the limits of the service, refused as early as can be."""

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import Request, Response
from fastapi.routing import APIRoute

from api.http.body_parsing import BodyTooLargeError, parse_json, read_limited
from api.http.limits import ServiceLimits


def limits_of(request: Request) -> ServiceLimits:
    """Return how much may be asked of the service."""
    limits: ServiceLimits = request.app.state.limits
    return limits


async def read_body(request: Request, limit: int) -> bytes:
    """Return the whole body; nothing of it is read where its head says that it is too long.

    Args:
        request: What is asked.
        limit: Most bytes that it may have.

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
    """A route that reads its body strictly, up to a limit, before anything else is done.

    `curl -d` calls its body a form. It is read as JSON all the same; what a page of another site
    may send is decided before, by `api.http.gate`.
    """

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return the handler of the framework, given a request that is read already."""
        handle = super().get_route_handler()
        if self.body_field is None:
            return handle

        async def handle_json(request: Request) -> Response:
            return await handle(await _JsonRequest.read(request))

        return handle_json


class _JsonRequest(Request):
    """A request with its body read and parsed."""

    _raw = b""
    _parsed: object = None

    @classmethod
    async def read(cls, request: Request) -> "_JsonRequest":
        headers = [item for item in request.scope["headers"] if item[0] != b"content-type"]
        headers.append((b"content-type", b"application/json"))
        read = cls({**request.scope, "headers": headers}, request.receive)
        read._raw = await read_body(request, limits_of(request).json_bytes)
        read._parsed = parse_json(read._raw) if read._raw else None
        return read

    async def body(self) -> bytes:
        """Return the body as it was sent."""
        return self._raw

    async def json(self) -> object:
        """Return what the body says."""
        return self._parsed
