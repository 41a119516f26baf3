"""How zenoh is set up for the computers of a robot: who connects where, and who may say what.

Each message has a key that names its receiver and its sender. With certificates, a computer takes a
message only from the connection whose certificate has the name of the sender, and lets a computer
receive only what is for it.
"""

import re
from collections.abc import Iterable, Sequence

from domain.computers import ComputerName
from domain.errors import InvalidValueError
from service.link.certificates import Certificates
from service.link.endpoints import Endpoints, is_on_this_machine
from service.link.port import MAX_MESSAGE_BYTES

BEAT, MESSAGE = "beat", "message"
"""Kinds of messages; the last part of a key."""

_PREFIX = "pilothouse"
_ENCRYPTED = ("quic", "tls")
_RETRY_MS = 100
_MAX_RETRY_MS = 200
"""Zenoh waits up to 4 s between two attempts by default, in which a robot would stay cut off."""
_OPEN_MS = 2_000
"""An attempt that was begun during a cut is given up; by default, it takes 10 s. Time for one
packet of the handshake that was lost to be sent again, after 1 s."""
_LEASE_MS = 2_000
"""A connection in which nothing is heard for so long is given up, with all that waits in it, and
made anew. Longer than `lost_s`, since the connection is not what decides about that."""
_QUEUED_BATCHES = 8
"""Of 64 KiB, for what must not be lost."""
_WAIT_US = 100
"""For room in a full queue; it is the event loop that waits. By default, 1 ms."""
_OVERHEAD_BYTES = 2**16


def key(to: ComputerName, sender: ComputerName, kind: str) -> str:
    """Return the key of messages of a kind from one computer to another."""
    return f"{_PREFIX}/{to}/{sender}/{kind}"


def configuration(
    name: ComputerName,
    others: Sequence[ComputerName],
    endpoints: Endpoints,
    certificates: Certificates | None,
) -> dict[str, object]:
    """Return the configuration of zenoh for a computer.

    Args:
        name: Of this computer.
        others: All other computers of the robot.
        endpoints: Where it listens and connects; it always listens, since two that only connect
            to the same third one would never hear each other.
        certificates: None: there are none, and all is on loopback or deliberately open.
    """
    link: dict[str, object] = {
        "tx": {"lease": _LEASE_MS, "queue": _queue()},
        # Bounds what is put together of the parts of a message that is not complete.
        "rx": {"max_message_size": MAX_MESSAGE_BYTES + _OVERHEAD_BYTES},
    }
    made: dict[str, object] = {
        "mode": "peer",
        "listen": {"endpoints": _listened_at(endpoints.listen)},
        "connect": looking_at(map(_with_datagrams, endpoints.connect)),
        # Nobody is looked for by multicast; devices learn of each other from the supervisor.
        "scouting": {"delay": 0, "multicast": {"enabled": False}, "gossip": {"enabled": True}},
        "open": {"return_conditions": {"connect_scouted": False, "declares": False}},
        "transport": {
            "unicast": {"open_timeout": _OPEN_MS, "accept_timeout": _OPEN_MS},
            "shared_memory": {"enabled": False},
            "link": link,
        },
    }
    if certificates is not None:
        link["tls"] = _tls(certificates)
        made["access_control"] = access_control(name, others)
    return made


def looking_at(endpoints: Iterable[str]) -> dict[str, object]:
    """Return the part `connect` of a configuration."""
    retry = {
        "period_init_ms": _RETRY_MS,
        "period_max_ms": _MAX_RETRY_MS,
        "period_increase_factor": 2,
    }
    return {"endpoints": list(endpoints), "retry": retry}


def over_tls(endpoint: str) -> str:
    """Return where a computer is found over TLS that is found over QUIC at an endpoint."""
    protocol, _, address = endpoint.partition("/")
    return f"tls/{re.split('[?#]', address)[0]}" if protocol == "quic" else endpoint


def at_any_port(endpoint: str) -> str:
    """Return an endpoint of the same address at a port that is free."""
    address, separator, rest = _with_datagrams(endpoint).partition("?")
    return f"{address.rpartition(':')[0]}:0{separator}{rest}"


def access_control(name: ComputerName, others: Iterable[ComputerName]) -> dict[str, object]:
    """Return what other computers may do, each known by the name of its certificate.

    Whatever is not allowed is denied: queries, tokens, any other key, and anybody else.
    """
    rules: list[dict[str, object]] = []
    policies: list[dict[str, object]] = []
    for other in others:
        to_us, to_it = f"{_PREFIX}/{name}/{other}/*", f"{_PREFIX}/{other}/{name}/*"
        allowed = [
            _rule(f"{other} sends to {name}", "put", "ingress", to_us),
            _rule(f"{name} sends to {other}", "put", "egress", to_it),
            _rule(f"{other} receives of {name}", "declare_subscriber", "ingress", to_it),
            _rule(f"{name} receives of {other}", "declare_subscriber", "egress", to_us),
        ]
        rules += allowed
        policies.append({"subjects": [other], "rules": [rule["id"] for rule in allowed]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": [{"id": other, "cert_common_names": [other]} for other in others],
        "policies": policies,
    }


def check_endpoints(
    endpoints: Endpoints, certificates: Certificates | None, *, insecure: bool
) -> None:
    """Check that nobody but the computers of the robot can speak on the link.

    Args:
        endpoints: Of this computer.
        certificates: None: there are none.
        insecure: Whether to accept a network in which anybody may speak as any computer.

    Raises:
        InvalidValueError: Somebody else could; the message says what to do.
    """
    for endpoint in (*endpoints.listen, *endpoints.connect):
        is_encrypted = endpoint.partition("/")[0] in _ENCRYPTED
        if certificates is None and is_encrypted:
            raise InvalidValueError(
                f"link: {endpoint} needs certificates: give ca, certificate and key"
            )
        if certificates is not None and not is_encrypted:
            address = endpoint.partition("/")[2]
            raise InvalidValueError(
                f"link: {endpoint} does not use the certificates: say quic/{address}"
            )
        if certificates is None and not insecure and not is_on_this_machine([endpoint]):
            raise InvalidValueError(
                f"link: {endpoint} is a network, and without certificates anybody there could "
                "command the robot: give ca, certificate and key, or allow it with --insecure-link"
            )


def _rule(name: str, message: str, flow: str, key_expression: str) -> dict[str, object]:
    return {
        "id": name,
        "permission": "allow",
        "messages": [message],
        "flows": [flow],
        "key_exprs": [key_expression],
    }


def _queue() -> dict[str, object]:
    return {
        "size": {"data": _QUEUED_BATCHES},
        "congestion_control": {"drop": {"wait_before_drop": _WAIT_US}},
    }


def _tls(files: Certificates) -> dict[str, object]:
    return {
        "root_ca_certificate": files.ca,
        "listen_certificate": files.certificate,
        "listen_private_key": files.key,
        "connect_certificate": files.certificate,
        "connect_private_key": files.key,
        "enable_mtls": True,
        # Access control knows who it is, wherever it is; the address proves nothing more.
        "verify_name_on_connect": False,
    }


def _listened_at(endpoints: Sequence[str]) -> list[str]:
    """Return where to listen: at a port of QUIC also for TLS, if that is free."""
    detours = [
        f"{over_tls(endpoint)}#exit_on_failure=false"
        for endpoint in endpoints
        if endpoint.startswith("quic/") and not over_tls(endpoint).endswith(":0")
    ]
    return [*map(_with_datagrams, endpoints), *detours]


def _with_datagrams(endpoint: str) -> str:
    """Let QUIC send what may be lost as datagrams, which are not sent again and wait for none."""
    address, separator, rest = endpoint.partition("#")
    if address.startswith("quic/") and "?" not in address:
        address += "?mixed_rel=auto"
    return address + separator + rest
