"""Start uvicorn with one WebSocket application, on a free port."""

import asyncio

import uvicorn
from uvicorn._types import ASGI3Application
from uvicorn.config import WSProtocolType

_serving: list[asyncio.Task[None]] = []


async def start(app: ASGI3Application, ws: type[asyncio.Protocol] | WSProtocolType) -> int:
    """Begin to serve, and return the port.

    Args:
        app: What is served.
        ws: Protocol of WebSockets, by its name or its class.
    """
    config = uvicorn.Config(
        app,
        port=0,
        ws=ws,
        ws_per_message_deflate=False,
        lifespan="off",
        log_level="warning",
        access_log=False,
    )
    server = uvicorn.Server(config)
    _serving.append(asyncio.create_task(server.serve()))
    # It tells nobody.
    while not server.started:  # noqa: ASYNC110
        await asyncio.sleep(0.01)
    port: int = server.servers[0].sockets[0].getsockname()[1]
    return port
