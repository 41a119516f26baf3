"""Frames to all clients by uvicorn as it comes: an ASGI application that sends to one by one."""

from functools import partial

from uvicorn._types import ASGIReceiveCallable, ASGISendCallable, Scope

from tests.support.fan_out.control import serve_frames
from tests.support.fan_out.uvicorn_start import start

_clients: dict[ASGISendCallable, None] = {}


async def _app(scope: Scope, receive: ASGIReceiveCallable, send: ASGISendCallable) -> None:
    await receive()
    await send({"type": "websocket.accept", "subprotocol": None, "headers": []})
    _clients[send] = None
    while (await receive())["type"] != "websocket.disconnect":
        pass
    _clients.pop(send, None)


async def _send(text: str) -> None:
    for send in list(_clients):
        try:
            await send({"type": "websocket.send", "bytes": None, "text": text})
        except OSError:
            _clients.pop(send, None)


if __name__ == "__main__":
    serve_frames(partial(start, _app, "websockets-sansio"), _send)
