"""The certificate of this computer, by which the others know it."""

import ssl
from collections.abc import Mapping
from itertools import chain
from typing import Any, NamedTuple

from domain.computers import ComputerName
from domain.errors import InvalidValueError

_FLIGHTS = 4
"""Turns of a handshake, with one to spare."""


class Certificates(NamedTuple):
    """Files of one computer, PEM."""

    ca: str
    """Of the authority that signed the certificates of all computers of the robot."""
    certificate: str
    key: str


def check_certificates(files: Certificates, name: ComputerName) -> None:
    """Check that other computers would accept this one by its name.

    Makes a handshake with itself: so each file is read, the key fits, the authority signed the
    certificate, and that is valid today.

    Args:
        files: Of this computer.
        name: Its name; that of the certificate must be the same.

    Raises:
        InvalidValueError: They would not; the message says why.
    """
    server = _context(files, ssl.PROTOCOL_TLS_SERVER)
    client = _context(files, ssl.PROTOCOL_TLS_CLIENT)
    try:
        found = _handshake(server, client)
    except ssl.SSLError as error:
        why = getattr(error, "verify_message", None) or error.reason or str(error)
        raise InvalidValueError(f"link: the certificate {files.certificate}: {why}") from None
    if found != name:
        raise InvalidValueError(
            f"link: the certificate {files.certificate} is of {found!r}, and this is {name!r}: "
            f"make one whose common name is {name!r}"
        )


def _context(files: Certificates, protocol: int) -> ssl.SSLContext:
    """Return how one end checks the other.

    Raises:
        InvalidValueError: A file cannot be read, or the key is not that of the certificate.
    """
    context = ssl.SSLContext(protocol)
    context.check_hostname = False
    context.verify_mode = ssl.CERT_REQUIRED
    try:
        context.load_verify_locations(files.ca)
    except (OSError, ssl.SSLError) as error:
        raise InvalidValueError(f"link: ca {files.ca}: {_reason(error)}") from None
    try:
        context.load_cert_chain(files.certificate, files.key)
    except (OSError, ssl.SSLError) as error:
        both = f"certificate {files.certificate} with key {files.key}"
        raise InvalidValueError(f"link: {both}: {_reason(error)}") from None
    return context


def _reason(error: OSError) -> str:
    if isinstance(error, ssl.SSLError):
        return (error.reason or "not PEM").lower().replace("_", " ")
    return error.strerror or str(error)


def _handshake(server: ssl.SSLContext, client: ssl.SSLContext) -> str:
    """Return the common name of the certificate that the ends show each other.

    Raises:
        ssl.SSLError: An end does not accept it.
    """
    to_server, to_client = ssl.MemoryBIO(), ssl.MemoryBIO()
    ends = (
        client.wrap_bio(to_client, to_server),
        server.wrap_bio(to_server, to_client, server_side=True),
    )
    for _ in range(_FLIGHTS):
        for end in ends:
            try:
                end.do_handshake()
            except ssl.SSLWantReadError:
                continue
    shown: Mapping[str, Any] = ends[1].getpeercert() or {}
    fields = chain.from_iterable(shown.get("subject", ()))
    return next((value for key, value in fields if key == "commonName"), "")
