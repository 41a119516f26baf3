"""Requests to a running service, one at a time; for commands that ask and wait for the answer.

It needs nothing but the HTTP interface, so that it works against any service within reach.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from urllib.parse import quote

import httpx

from api.client.address import Address
from api.client.outcomes import Json, NoAnswerError, ServiceProblemError, token_hint

_TIMEOUT = httpx.Timeout(10.0, connect=3.0)


class ServiceClient:
    """A running service."""

    def __init__(self, address: Address, transport: httpx.BaseTransport | None = None) -> None:
        """Prepare to talk to the service; nothing is sent yet.

        Args:
            address: Where the service runs, and the token that goes with each request.
            transport: How requests are sent; None: over the network.
        """
        self.url = address.url
        self._has_token = address.token is not None
        self._http = httpx.Client(
            base_url=address.url,
            timeout=_TIMEOUT,
            # A proxy of the environment does not lead back to this machine.
            trust_env=address.loopback is None,
            transport=transport,
            headers=address.headers,
        )

    def close(self) -> None:
        """Close the connection."""
        self._http.close()

    def path_of(self, part: str) -> str:
        """Return the path of a system or node.

        Raises:
            ServiceProblemError: There is no such part.
            NoAnswerError: Nobody answered.
        """
        path = f"/systems/{quote(part)}"
        try:
            self.call("GET", path)
        except ServiceProblemError as error:
            if error.problem.get("status") != httpx.codes.NOT_FOUND:
                raise
            path = f"/nodes/{quote(part)}"
            self.call("GET", path)
        return path

    def call(
        self,
        method: str,
        path: str,
        body: Json | None = None,
        *,
        csv: str | None = None,
        query: Mapping[str, str | int | float] | None = None,
    ) -> Json:
        """Send one request and return the JSON object of the answer; without content, an empty one.

        Args:
            method: As in `GET`.
            path: As in `/tasks`.
            body: Sent as JSON.
            csv: Sent instead of `body`.
            query: What follows the path.

        Raises:
            ServiceProblemError: It was refused.
            NoAnswerError: Nobody answered, or not in JSON; whether it was done is not known.
        """
        try:
            content = None if csv is None else csv.encode()
            headers = {} if csv is None else {"Content-Type": "text/csv"}
            response = self._http.request(
                method, path, json=body, content=content, headers=headers, params=query or None
            )
        except httpx.ConnectError as error:
            raise NoAnswerError(f"no service answers at {self.url}: is it running?") from error
        except httpx.HTTPError as error:
            raise NoAnswerError(f"no answer from {self.url}: {error}") from error
        if response.status_code == httpx.codes.NO_CONTENT:
            return {}
        try:
            answer = response.json()
        except ValueError:
            answer = None
        if not isinstance(answer, dict):
            raise NoAnswerError(f"what answers at {self.url} is not Pilothouse")
        if response.status_code == httpx.codes.UNAUTHORIZED:
            answer["hint"] = token_hint(given=self._has_token)
        if response.is_error:
            raise ServiceProblemError(answer)
        return answer


@contextmanager
def service_at(url: str) -> Iterator[ServiceClient]:
    """Return a client with the token of the environment, closed at the end of the context.

    Raises:
        NoAnswerError: Nobody can be asked: the address is none, or the token cannot be used.
    """
    client = ServiceClient(Address.with_token_of_environment(url))
    try:
        yield client
    finally:
        client.close()
