"""Frames to all clients by picows."""

from picows import WSListener, WSMsgType, WSTransport, WSUpgradeRequest, ws_create_server

from tests.support.fan_out.control import serve_frames

_clients: set[WSTransport] = set()


class _Client(WSListener):
    def on_ws_connected(self, transport: WSTransport) -> None:
        _clients.add(transport)

    def on_ws_disconnected(self, transport: WSTransport) -> None:
        _clients.discard(transport)


def _listener(request: WSUpgradeRequest) -> WSListener:
    return _Client()


async def _start() -> int:
    server = await ws_create_server(_listener, "127.0.0.1", 0)
    port: int = server.sockets[0].getsockname()[1]
    return port


async def _send(text: str) -> None:
    payload = text.encode()
    for client in _clients:
        client.send(WSMsgType.TEXT, payload)


if __name__ == "__main__":
    serve_frames(_start, _send)
