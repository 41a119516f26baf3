"""To be the server of an application that is plain ASGI."""

from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from tests.support.http_robot import http_scope


async def answer_200(scope: Scope, receive: Receive, send: Send) -> None:
    """Answer whatever is asked."""
    await send({"type": "http.response.start", "status": 200, "headers": []})


def websocket_scope(headers: dict[str, str]) -> dict[str, Any]:
    """Return the ASGI scope of a handshake."""
    scope = http_scope("GET", "/ws", **headers)
    del scope["method"]
    return {**scope, "type": "websocket"}


async def messages_of(app: ASGIApp, scope: dict[str, Any]) -> list[Message]:
    """Return what an application sends for a request without a body."""
    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    await app(scope, receive, send)
    return sent


async def status_of(app: ASGIApp, scope: dict[str, Any]) -> int:
    """Return the status of the answer."""
    status: int = (await messages_of(app, scope))[0]["status"]
    return status
