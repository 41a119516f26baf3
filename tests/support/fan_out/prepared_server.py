"""Prepared frames to all clients by uvicorn with our protocol, and without a robot."""

import asyncio
from functools import partial

from uvicorn._types import ASGIReceiveCallable, ASGISendCallable, Scope

from api.serving.websocket_protocol import WebSocketProtocol
from api.streaming.websocket_frames import connection_of, text_frame
from tests.support.fan_out.control import serve_frames
from tests.support.fan_out.uvicorn_start import start

_clients: dict[asyncio.WriteTransport, None] = {}


async def _app(scope: Scope, receive: ASGIReceiveCallable, send: ASGISendCallable) -> None:
    await receive()
    await send({"type": "websocket.accept", "subprotocol": None, "headers": []})
    connection = connection_of(dict(scope))
    connection.let_in()
    transport = connection.transport
    _clients[transport] = None
    while (await receive())["type"] != "websocket.disconnect":
        pass
    _clients.pop(transport, None)


async def _send(text: str) -> None:
    content = text_frame(text)
    for transport in _clients:
        transport.write(content)


if __name__ == "__main__":
    serve_frames(partial(start, _app, WebSocketProtocol), _send)
