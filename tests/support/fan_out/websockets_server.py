"""Frames to all clients by `websockets.broadcast`."""

from websockets.asyncio.server import ServerConnection, broadcast, serve

from tests.support.fan_out.control import serve_frames

_clients: set[ServerConnection] = set()


async def _serve_client(client: ServerConnection) -> None:
    _clients.add(client)
    try:
        await client.wait_closed()
    finally:
        _clients.discard(client)


async def _start() -> int:
    server = await serve(_serve_client, "127.0.0.1", 0, compression=None)
    port: int = next(iter(server.sockets)).getsockname()[1]
    return port


async def _send(text: str) -> None:
    broadcast(_clients, text)


if __name__ == "__main__":
    serve_frames(_start, _send)
