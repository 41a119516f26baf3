"""Where the computers of a robot listen for each other, and where they look for each other."""

import ipaddress
from collections.abc import Iterable, Sequence
from typing import NamedTuple

USUAL = "tcp/127.0.0.1:7470"
"""Where the supervisor listens if the robot file does not say; not zenoh's own port 7447, at which
a robot with ROS 2 may have a router."""


class Endpoints(NamedTuple):
    """Endpoints of one computer, such as `quic/10.0.0.1:7470`."""

    listen: tuple[str, ...]
    connect: tuple[str, ...]


def of_supervisor(listen: Sequence[str], connect: Sequence[str], given: Sequence[str]) -> Endpoints:
    """Return the endpoints of the supervisor, which devices look for.

    Args:
        listen: Of the robot file.
        connect: Of the robot file: where devices find the supervisor.
        given: On the command line: where this computer listens.
    """
    return Endpoints(tuple(given or listen or connect or (USUAL,)), ())


def of_device(listen: Sequence[str], connect: Sequence[str], given: Sequence[str]) -> Endpoints:
    """Return the endpoints of a device; the arguments are those of `of_supervisor`.

    It listens too, at a port that the other devices learn from the supervisor: an emergency stop
    goes from each computer to each other one, also when the supervisor is dead.
    """
    found = tuple(connect) or tuple(map(_reachable, listen)) or (USUAL,)
    return Endpoints(tuple(given) or (_any_port(found),), found)


def is_on_this_machine(endpoints: Iterable[str]) -> bool:
    """Tell whether all endpoints are on loopback."""
    return all(_is_loopback(_host(endpoint)) for endpoint in endpoints)


def _reachable(endpoint: str) -> str:
    """Return where somebody on the same machine finds who listens at an endpoint."""
    protocol, _, address = endpoint.partition("/")
    port = address.rpartition(":")[2]
    host = _host(endpoint)
    if host in {"0.0.0.0", "::", "[::]"}:  # compared only
        return f"{protocol}/{'127.0.0.1' if '.' in host else '[::1]'}:{port}"
    return endpoint


def _any_port(found: Sequence[str]) -> str:
    """Return where a device listens that finds its supervisor at these endpoints."""
    protocol = found[0].partition("/")[0]
    host = "127.0.0.1" if is_on_this_machine(found) else "0.0.0.0"  # of a network
    return f"{protocol}/{host}:0"


def _host(endpoint: str) -> str:
    address = endpoint.partition("/")[2]
    return address.partition("?")[0].partition("#")[0].rpartition(":")[0]


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False
