"""Where the computers of a robot listen for each other, and where they look for each other."""

import ipaddress
import socket
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

USUAL = "tcp/127.0.0.1:7470"
"""Where the supervisor listens if the robot file does not say; not zenoh's own port 7447, at which
a robot with ROS 2 may have a router."""


class Endpoints(NamedTuple):
    """Endpoints of one computer, such as `quic/10.0.0.1:7470`."""

    listen: tuple[str, ...]
    connect: tuple[str, ...]


def is_own_address(host: str) -> bool:
    """Tell whether a host is this machine; one that cannot be looked up is not."""
    try:
        found = socket.getaddrinfo(host.strip("[]"), 0, type=socket.SOCK_STREAM)
        for family, kind, protocol, _, address in found:
            with socket.socket(family, kind, protocol) as tried:
                tried.bind(address)
    except OSError:
        return False
    return True


def of_supervisor(
    listen: Sequence[str],
    connect: Sequence[str],
    given: Sequence[str],
    is_here: Callable[[str], bool] = is_own_address,
) -> Endpoints:
    """Return the endpoints of the supervisor, which devices look for.

    One that listens elsewhere than devices look connects there, so that devices hear it: they
    refuse it while they follow another one, and it is told.

    Args:
        listen: Of the robot file.
        connect: Of the robot file: where devices find the supervisor.
        given: On the command line: where this computer listens.
        is_here: Tells whether a host is this machine.
    """
    looked_for = tuple(connect) or tuple(map(_reachable, listen)) or (USUAL,)
    own = tuple(given or listen or looked_for)
    ports = set(map(_port, own))
    others = (to for to in looked_for if _port(to) not in ports or not is_here(_host(to)))
    return Endpoints(own, tuple(others))


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
    protocol = endpoint.partition("/")[0]
    port, host = _port(endpoint), _host(endpoint)
    if host in {"0.0.0.0", "::", "[::]"}:  # compared only
        return f"{protocol}/{'127.0.0.1' if '.' in host else '[::1]'}:{port}"
    return endpoint


def _any_port(found: Sequence[str]) -> str:
    """Return where a device listens that finds its supervisor at these endpoints."""
    protocol = found[0].partition("/")[0]
    host = "127.0.0.1" if is_on_this_machine(found) else "0.0.0.0"  # of a network
    return f"{protocol}/{host}:0"


def _host(endpoint: str) -> str:
    return _address(endpoint).rpartition(":")[0]


def _port(endpoint: str) -> str:
    return _address(endpoint).rpartition(":")[2]


def _address(endpoint: str) -> str:
    return endpoint.partition("/")[2].partition("?")[0].partition("#")[0]


def _is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False
