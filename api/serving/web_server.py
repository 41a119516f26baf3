"""Uvicorn within our process: with our signal handling and our limits."""

import asyncio
import contextlib
import errno
import ipaddress
import socket
from collections.abc import Awaitable, Callable, Generator, Sequence
from functools import partial
from typing import cast

import uvicorn
from fastapi import FastAPI

from api.app import close_workers
from api.http.limits import ServiceLimits
from api.serving.closings import Closings, ClosingsCollector
from api.serving.connections import Connections
from api.serving.http_protocol import HttpProtocol, urgency_of
from api.serving.intake import Intake
from api.serving.turns import Turns
from api.serving.websocket_protocol import WebSocketProtocol

_SEND_BUFFER_BYTES = 65_536
_BACKLOG = 1_024
"""Connections that wait to be accepted. With fewer, hundreds that come at once make the kernel drop
those of others, who try again only after a second."""
_GRACE_S = 1
_REQUESTS = 500
"""Connections of requests and of rosbridge, beside those of the stream."""
_OTHER_FILES = 100
"""Descriptors kept for what are no connections: listeners, pipes to workers, files."""


class ListenError(Exception):
    """The service cannot listen on the address; the message says why, and what to do."""


class WebServer(uvicorn.Server):
    """Uvicorn without its signal handling.

    Uvicorn raises SIGTERM again once it has stopped serving, which would end the process before the
    rest of it is wound down. The composition root owns the signals.
    """

    def __init__(
        self,
        config: uvicorn.Config,
        connections: Connections,
        closings: Closings,
        on_started: Callable[[], None],
        on_stopping: Callable[[], Awaitable[None]],
    ) -> None:
        super().__init__(config)
        self._connections = connections
        self._closings = closings
        self._on_started = on_started
        self._on_stopping = on_stopping

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start to accept connections, and call `on_started`."""
        await super().startup([])
        turns = Turns.of(asyncio.get_running_loop())

        def make() -> Intake:
            state = self.lifespan.state
            inner = HttpProtocol(self.config, self.server_state, state, self._closings)
            return Intake(inner, turns, self._connections, urgency_of)

        self._connections.start(sockets or [], make)
        self._on_started()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Accept no more, await `on_stopping`, and end what there is."""
        self._connections.stop()
        await self._on_stopping()
        await super().shutdown(sockets)

    @contextlib.contextmanager
    def capture_signals(self) -> Generator[None, None, None]:
        """Capture nothing."""
        yield


def web_server(app: FastAPI, on_started: Callable[[], None]) -> WebServer:
    """Return a server that is stopped by `should_exit`.

    Args:
        app: The application, with its limits.
        on_started: Called once connections are accepted.
    """
    limits: ServiceLimits = app.state.limits
    wanted = limits.stream_clients + _REQUESTS
    most = max(_OTHER_FILES, _allow_open_files(wanted + _OTHER_FILES) - _OTHER_FILES)
    closings = Closings()
    app.state.metrics.registry.register(ClosingsCollector(closings))
    config = uvicorn.Config(
        app,
        http=HttpProtocol,
        ws=cast("type[WebSocketProtocol]", partial(WebSocketProtocol, closings=closings)),
        ws_max_size=limits.message_bytes,
        ws_per_message_deflate=False,
        # By `api.streaming.fan_out`, to all at once.
        ws_ping_interval=None,
        lifespan="on",
        log_config=None,
        access_log=False,
        server_header=False,
        # Otherwise a header of the client would decide which address is recorded for it.
        proxy_headers=False,
        timeout_graceful_shutdown=_GRACE_S,
    )
    # Now and not at the start of the server, when the tick is running already.
    config.load()
    connections = Connections(min(wanted, most), closings)
    # The jobs of requests fail first, so that these are answered.
    stopping = partial(close_workers, app)
    return WebServer(config, connections, closings, on_started, stopping)


def listen(host: str, port: int) -> list[socket.socket]:
    """Listen on all addresses of `host`, before anything else of the service begins.

    Args:
        host: Name or address.
        port: 0 takes a free one.

    Raises:
        ListenError: There is no such host, or the port is not available.
    """
    sockets: list[socket.socket] = []
    failure: OSError | None = None
    try:
        for family, address in _addresses(host):
            try:
                sockets.append(_listener(family, address, port))
            except OSError as error:
                # `localhost` has an IPv6 address even where the machine has no IPv6.
                if error.errno not in (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT):
                    raise
                failure = error
            else:
                port = sockets[-1].getsockname()[1]
        if not sockets and failure is not None:
            raise failure
    except OSError as error:
        for listener in sockets:
            listener.close()
        raise ListenError(_why(error, host, port)) from error
    return sockets


def is_loopback(host: str) -> bool:
    """Tell whether only this machine can reach `host`.

    Raises:
        ListenError: There is no such host.
    """
    try:
        addresses = [address for _, address in _addresses(host)]
    except OSError as error:
        raise ListenError(_why(error, host, 0)) from error
    return all(ipaddress.ip_address(address).is_loopback for address in addresses)


def url_of(sockets: Sequence[socket.socket], host: str) -> str:
    """Return the address to open in a browser."""
    address, port = sockets[0].getsockname()[:2]
    if ipaddress.ip_address(address).is_unspecified:
        host = _own_address(sockets[0].family) or "127.0.0.1"
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def _own_address(family: socket.AddressFamily) -> str | None:
    """Return the address by which this machine is reached from elsewhere; None: it has none.

    Connecting a socket for datagrams sends nothing: it only looks up the route.
    """
    outside = "2001:db8::1" if family == socket.AF_INET6 else "192.0.2.1"
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as probe:
            probe.connect((outside, 9))
            return str(probe.getsockname()[0])
    except OSError:
        return None


def _allow_open_files(count: int) -> int:
    """Raise the limit of open files and connections as far as this process may; return it."""
    try:
        import resource
    except ImportError:  # There is none for Windows.
        return count
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = count if hard == resource.RLIM_INFINITY else min(count, hard)
    if soft == resource.RLIM_INFINITY or soft >= most:
        return count if soft == resource.RLIM_INFINITY else soft
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
    return most


def _listener(family: socket.AddressFamily, address: str, port: int) -> socket.socket:
    listener = socket.create_server((address, port), family=family, backlog=_BACKLOG)
    # Small, so that a client that does not read is detected soon: the kernel would buffer megabytes
    # of old data. Connections inherit it.
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _SEND_BUFFER_BYTES)
    return listener


def _addresses(host: str) -> list[tuple[socket.AddressFamily, str]]:
    found = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    return list(dict.fromkeys((family, str(address[0])) for family, _, _, _, address in found))


def _why(error: OSError, host: str, port: int) -> str:
    if error.errno == errno.EADDRINUSE:
        return f"port {port} of {host} is in use, perhaps by another Pilothouse; see --port"
    if isinstance(error, socket.gaierror):
        return f"there is no host {host!r}"
    return f"cannot listen on port {port} of {host}: {error.strerror or error}"
