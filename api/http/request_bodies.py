"""Bodies as they come over HTTP: within the limits of the service, refused as early as can be."""

from fastapi import Request

from api.http.bodies import BodyTooLargeError, read_limited
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
