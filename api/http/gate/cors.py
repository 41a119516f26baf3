"""Headers that let pages of allowed origins read answers (CORS, part of the Fetch standard)."""

from typing import ClassVar

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.http.gate.origins import AllowedOrigins
from api.http.kept_requests import DURABLE_HEADER


class CorsHeaders:
    """Adds the headers, also to rejections, so that a page can show why it was rejected.

    The origin is named, never a wildcard. No cookie is ever used, so credentials are not allowed.
    """

    EXPOSED: ClassVar = f"Allow, ETag, Location, {DURABLE_HEADER}, Retry-After, WWW-Authenticate"

    def __init__(self, app: ASGIApp, allowed: AllowedOrigins) -> None:
        """Watch `app`.

        Args:
            app: What is behind this.
            allowed: Origins other than that of the service.
        """
        self._app = app
        self._allowed = allowed

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and mark its answer."""
        if scope["type"] != "http" or not self._allowed:
            await self._app(scope, receive, send)
            return
        origins = Headers(scope=scope).getlist("origin")

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                headers.add_vary_header("Origin")
                if len(origins) == 1 and origins[0] in self._allowed:
                    headers["Access-Control-Allow-Origin"] = origins[0]
                    headers["Access-Control-Expose-Headers"] = self.EXPOSED
            await send(message)

        await self._app(scope, receive, send_with_headers)
