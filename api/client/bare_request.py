"""One HTTP request over a connection of its own, with nothing but the standard library.

For what has to work when little else does, and has to start quickly: `pilothouse stop`, and the
names that a shell completes.
"""

import http.client
import json
from dataclasses import dataclass
from urllib.parse import urlsplit

from api.client.address import Address
from api.client.outcomes import Json, NoAnswerError, no_connection

_MOST_BYTES = 16 * 2**20


@dataclass(frozen=True, slots=True)
class Answer:
    """The answer of a service."""

    status: int
    body: Json
    is_volatile: bool
    """Whether a restart of the service may forget what was asked."""


def bare_request(
    address: Address,
    method: str,
    path: str,
    timeout_s: float,
    body: Json | None = None,
) -> Answer:
    """Send a request past any proxy, and return the answer, whatever its status.

    Args:
        address: URL of the service, and the token.
        method: HTTP method, such as `PUT`.
        path: URL path, such as `/emergency_stop`.
        timeout_s: Longest time to connect, and then between two pieces of the answer; looking up
            the name of a host may take longer.
        body: Request body, sent as JSON.

    Raises:
        NoAnswerError: There was no answer, or not in JSON; whether the request had an effect is
            unknown.
    """
    parts = urlsplit(address.url)
    connection = _connection(parts.scheme, parts.hostname or "", parts.port, timeout_s)
    try:
        try:
            connection.connect()
        except (OSError, UnicodeError) as error:
            # UnicodeError: a name that no host can have.
            raise no_connection(address.url, error) from error
        content = None if body is None else json.dumps(body).encode()
        headers = {"Accept": "application/json", "Connection": "close", **address.headers}
        if content is not None:
            headers["Content-Type"] = "application/json"
        connection.request(method, parts.path + path, content, headers)
        answer = connection.getresponse()
        found = _object_in(answer.read(_MOST_BYTES))
    except (OSError, http.client.HTTPException) as error:
        why = "timed out" if isinstance(error, TimeoutError) else str(error) or repr(error)
        raise NoAnswerError(f"no answer from {address.url}: {why}") from error
    finally:
        connection.close()
    if found is None:
        raise NoAnswerError(f"what answers at {address.url} is not Pilothouse")
    return Answer(answer.status, found, answer.getheader("Pilothouse-Durable") == "false")


def _connection(
    scheme: str, host: str, port: int | None, timeout_s: float
) -> http.client.HTTPConnection:
    if scheme == "https":
        return http.client.HTTPSConnection(host, port, timeout=timeout_s)
    return http.client.HTTPConnection(host, port, timeout=timeout_s)


def _object_in(content: bytes) -> Json | None:
    try:
        found = json.loads(content)
    except ValueError:
        return None
    return found if isinstance(found, dict) else None
