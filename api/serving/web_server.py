"""Uvicorn within our process: with our signal handling and our limits."""

import contextlib
import errno
import ipaddress
import socket
from collections.abc import Callable, Generator, Sequence

import uvicorn
from fastapi import FastAPI
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from api.http.limits import ServiceLimits
from api.serving.websocket_protocol import WebSocketProtocol

MAX_HEAD_BYTES = 65_536
_SEND_BUFFER_BYTES = 65_536
_GRACE_S = 1
_OTHER_FILES = 500
"""Beside those of the stream: connections of requests, pipes to workers, files."""


class ListenError(Exception):
    """The service cannot listen on the address; the message says why, and what to do."""


class WebServer(uvicorn.Server):
    """Uvicorn without its signal handling.

    Uvicorn raises SIGTERM again once it has stopped serving, which would end the process before the
    rest of it is wound down. The composition root owns the signals.
    """

    def __init__(self, config: uvicorn.Config, on_started: Callable[[], None]) -> None:
        super().__init__(config)
        self._on_started = on_started

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start to accept connections, and call `on_started`."""
        await super().startup(sockets)
        self._on_started()

    @contextlib.contextmanager
    def capture_signals(self) -> Generator[None, None, None]:
        """Capture nothing."""
        yield


class _Http(HttpToolsProtocol):
    """HTTP/1.1 whose request heads have a limit; the parser in C has none."""

    _in_head = False
    _head_bytes = 0

    def on_message_begin(self) -> None:
        super().on_message_begin()
        self._in_head = True
        self._head_bytes = 0

    def on_headers_complete(self) -> None:
        super().on_headers_complete()
        self._in_head = False

    def data_received(self, data: bytes) -> None:
        super().data_received(data)
        if self._in_head and not self.transport.is_closing():
            self._head_bytes += len(data)
            if self._head_bytes > MAX_HEAD_BYTES:
                self.send_400_response("The head of the request is too large.")


def web_server(app: FastAPI, on_started: Callable[[], None]) -> WebServer:
    """Return a server that is stopped by `should_exit`.

    Args:
        app: The application, with its limits.
        on_started: Called once connections are accepted.
    """
    limits: ServiceLimits = app.state.limits
    _allow_open_files(limits.stream_clients + _OTHER_FILES)
    config = uvicorn.Config(
        app,
        http=_Http,
        ws=WebSocketProtocol,
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
    return WebServer(config, on_started)


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


def _allow_open_files(count: int) -> None:
    """Raise the limit of open files and connections, as far as this process may do so."""
    try:
        import resource
    except ImportError:  # There is none for Windows.
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    most = count if hard == resource.RLIM_INFINITY else min(count, hard)
    if soft != resource.RLIM_INFINITY and soft < most:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))


def _listener(family: socket.AddressFamily, address: str, port: int) -> socket.socket:
    listener = socket.create_server((address, port), family=family, backlog=128)
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
