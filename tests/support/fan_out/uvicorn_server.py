"""Frames to all clients by uvicorn as it comes: an ASGI application that sends to one by one."""

import asyncio

import uvicorn
from uvicorn._types import ASGIReceiveCallable, ASGISendCallable, Scope

from tests.support.fan_out.control import serve_frames

_clients: dict[ASGISendCallable, None] = {}
_serving: list[asyncio.Task[None]] = []


async def _app(scope: Scope, receive: ASGIReceiveCallable, send: ASGISendCallable) -> None:
    await receive()
    await send({"type": "websocket.accept", "subprotocol": None, "headers": []})
    _clients[send] = None
    while (await receive())["type"] != "websocket.disconnect":
        pass
    _clients.pop(send, None)


async def _start() -> int:
    server = uvicorn.Server(
        uvicorn.Config(
            _app,
            port=0,
            ws="websockets-sansio",
            lifespan="off",
            log_level="warning",
            access_log=False,
        )
    )
    _serving.append(asyncio.create_task(server.serve()))
    # It tells nobody.
    while not server.started:  # noqa: ASYNC110
        await asyncio.sleep(0.01)
    port: int = server.servers[0].sockets[0].getsockname()[1]
    return port


async def _send(text: str) -> None:
    for send in list(_clients):
        try:
            await send({"type": "websocket.send", "bytes": None, "text": text})
        except OSError:
            _clients.pop(send, None)


if __name__ == "__main__":
    serve_frames(_start, _send)
