"""The header that tells whether the outcome of a request would survive a restart."""

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.http.kept_requests import DURABLE, DURABLE_HEADER


class DurableHeader:
    """Adds the header to the answers of requests whose outcome is kept."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and say in its answer what was told meanwhile."""
        told: list[bool] = []

        async def send_with_header(message: Message) -> None:
            if message["type"] == "http.response.start" and told:
                MutableHeaders(scope=message)[DURABLE_HEADER] = "true" if all(told) else "false"
            await send(message)

        await self._app({**scope, DURABLE: told}, receive, send_with_header)
