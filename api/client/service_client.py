"""Blocking requests to a running service, for commands; needs only its HTTP interface."""

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
        """Prepare; nothing is sent yet.

        Args:
            address: Of the service, with the token for each request.
            transport: Sends the requests; None: over the network.
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
            NoAnswerError: There was no answer.
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
        """Send a request and return the JSON object of the answer; empty if it has no content.

        Args:
            method: For example `GET`.
            path: For example `/tasks`.
            body: Sent as JSON.
            csv: Sent instead of `body`.
            query: Query parameters.

        Raises:
            ServiceProblemError: The request was rejected.
            NoAnswerError: There was no answer in JSON; whether the request was processed is not
                known.
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
    """Provide a client with the token from the environment while the context is open.

    Raises:
        NoAnswerError: The address or the token is invalid.
    """
    client = ServiceClient(Address.with_token_of_environment(url))
    try:
        yield client
    finally:
        client.close()
