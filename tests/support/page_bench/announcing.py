"""Says where a server of the benches listens, as `pilothouse serve` does."""

import socket
from collections.abc import Iterable


def announce(sockets: Iterable[socket.socket]) -> None:
    """Print the address of the first socket."""
    port = next(iter(sockets)).getsockname()[1]
    print(f"page  http://127.0.0.1:{port}/\nCtrl-C", flush=True)
