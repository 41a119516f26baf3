"""A network with a long way: it passes bytes on, each of them later.

The browser's own throttle delays what a page asks for, and not a WebSocket or a handshake; this
delays whatever is sent. Opening a connection takes a round trip, too.
"""

import asyncio
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import closing, contextmanager, suppress

_CHUNK = 65_536
_STREAM = b"GET /ws"


class Relay:
    """Passes connections on.

    Args:
        port: Where they lead, on this machine.
        round_trip_s: How long a question and its answer are on their way, s.
        stream_port: Where the stream leads; None: as everything else.
    """

    def __init__(
        self, port: int, round_trip_s: float = 0.0, stream_port: int | None = None
    ) -> None:
        self._port = port
        self._stream_port = stream_port or port
        self._one_way_s = round_trip_s / 2

    async def serve(self) -> asyncio.Server:
        """Listen on any port."""
        return await asyncio.start_server(self._pass_on, "127.0.0.1", 0)

    async def _pass_on(self, near: asyncio.StreamReader, to_near: asyncio.StreamWriter) -> None:
        # The browser takes the connection for open at once; its first bytes wait for that.
        await asyncio.sleep(2 * self._one_way_s)
        with closing(to_near), suppress(ConnectionError):
            first = await near.read(_CHUNK)
            port = self._stream_port if first.startswith(_STREAM) else self._port
            far, to_far = await asyncio.open_connection("127.0.0.1", port)
            # Also where the relay ends before the connection does.
            with closing(to_far):
                await asyncio.gather(self._pump(near, to_far, first), self._pump(far, to_near))

    async def _pump(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, first: bytes = b""
    ) -> None:
        loop = asyncio.get_running_loop()
        under_way: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()

        async def deliver() -> None:
            while True:
                due, data = await under_way.get()
                await asyncio.sleep(due - loop.time())
                if not data:
                    writer.close()
                    return
                writer.write(data)

        delivering = asyncio.create_task(deliver())
        try:
            data = first or await reader.read(_CHUNK)
            while data:
                under_way.put_nowait((loop.time() + self._one_way_s, data))
                data = await reader.read(_CHUNK)
            under_way.put_nowait((loop.time() + self._one_way_s, b""))
            await delivering
        finally:
            delivering.cancel()


@contextmanager
def relayed(relay: Relay) -> Iterator[str]:
    """Let a relay run in a thread, and give its address."""
    listening: Future[tuple[int, Callable[[], object]]] = Future()

    async def run() -> None:
        loop, end = asyncio.get_running_loop(), asyncio.Event()
        server = await relay.serve()
        port = server.sockets[0].getsockname()[1]
        listening.set_result((port, lambda: loop.call_soon_threadsafe(end.set)))
        await end.wait()
        server.close()

    thread = threading.Thread(target=lambda: asyncio.run(run()), daemon=True)
    thread.start()
    port, end = listening.result()
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        end()
        thread.join()
